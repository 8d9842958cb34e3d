// Which points of a reconstruction are where they say, as far as its own measures tell.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "engine/io/colmap_model.hpp"

namespace palpate {

enum class Reliability : std::uint8_t {
  reliable,
  fewViews,    ///< fewer than three images saw it: two rays of one plane meet wherever they are taken from
  largeError,  ///< its projections lie too far from where the images have it
  smallAngle   ///< no two of its rays meet at an angle that says how deep it lies
};

/// By the rules that COLMAP itself filters with (Schoenberger and Frahm 2016, section 4; of its mapper the defaults of
/// `filter_max_reproj_error`, `filter_min_tri_angle` and `tri_ignore_two_view_tracks`): an error of 4 pixels at most,
/// two rays that meet at 1.5 degrees at least, taken as lines, and three images. A false match of two images has no
/// error: only a third one contradicts it. An error that nobody knows says nothing.
Reliability reliabilityOf(const ColmapPoint& point, const ColmapModel& model);

/// How many points of each kind there are.
class ReliabilityCounts {
 public:
  /// Whether the point is reliable.
  bool add(Reliability reliability);

  std::uint64_t leftOut() const { return all() - of(Reliability::reliable); }
  /// Whether they are more than the others: then the rules do not suit the reconstruction, as one of two images.
  bool isMost() const { return leftOut() > of(Reliability::reliable); }
  /// "12 of 400 points, which are unreliable: 9 with rays that meet at less than 1.5 degrees, 3 with errors of …".
  std::string sentence() const;

 private:
  std::uint64_t of(Reliability reliability) const { return counts_[static_cast<std::size_t>(reliability)]; }
  std::uint64_t all() const;

  std::array<std::uint64_t, 4> counts_{};
};

}  // namespace palpate
