// Classifies points of a reconstruction as reliable by its own measures.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "engine/io/colmap_model.hpp"

namespace palpate {

enum class Reliability : std::uint8_t {
  reliable,
  fewViews,    ///< seen by fewer than three images: two rays of one plane always meet
  largeError,  ///< its projections are too far from its observations
  smallAngle   ///< no two of its rays meet at an angle that determines its depth
};

/// By COLMAP's own filter rules (Schoenberger and Frahm 2016, section 4; the mapper's defaults of
/// `filter_max_reproj_error`, `filter_min_tri_angle` and `tri_ignore_two_view_tracks`): an error of at most 4 pixels,
/// two rays (taken as lines) that meet at 1.5 degrees or more, and three images. A false match of two images has no
/// error: only a third image contradicts it. An unknown error is accepted, as is a point whose images are unknown.
Reliability reliabilityOf(const ColmapPoint& point, const ColmapModel& model);

/// Number of points of each kind.
class ReliabilityCounts {
 public:
  /// Counts the point; returns whether it is reliable.
  bool add(Reliability reliability);

  std::uint64_t leftOut() const { return all() - of(Reliability::reliable); }
  /// Whether most points would be left out: then the rules do not suit the reconstruction, for example one of two
  /// images.
  bool isMost() const { return leftOut() > of(Reliability::reliable); }
  /// "12 of 400 points, which are unreliable: 9 with rays that meet at less than 1.5 degrees, 3 with errors of …".
  std::string sentence() const;

 private:
  std::uint64_t of(Reliability reliability) const { return counts_[static_cast<std::size_t>(reliability)]; }
  std::uint64_t all() const;

  std::array<std::uint64_t, 4> counts_{};
};

}  // namespace palpate
