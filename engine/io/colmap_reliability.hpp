// Which points of a reconstruction are where they say, as far as its own measures tell.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "engine/io/colmap_model.hpp"

namespace palpate {

enum class Reliability : std::uint8_t {
  reliable,
  fewViews,    ///< fewer than two images saw it: no rays meet there
  largeError,  ///< its projections lie too far from where the images have it
  smallAngle   ///< no two of its rays meet at an angle that says how deep it lies
};

/// By the rules that COLMAP itself filters with (Schoenberger and Frahm 2016, section 4.2; `filter_max_reproj_error` and
/// `filter_min_tri_angle` of its mapper): an error of 4 pixels at most, and two rays that meet at 1.5 degrees at least,
/// taken as lines. An error that nobody knows says nothing.
Reliability reliabilityOf(const ColmapPoint& point, const ColmapModel& model);

/// How many points of each kind there are.
class ReliabilityCounts {
 public:
  /// Whether the point is reliable.
  bool add(Reliability reliability);

  std::uint64_t leftOut() const { return all() - of(Reliability::reliable); }
  /// Whether there are points, and none is reliable.
  bool isAll() const { return all() > 0 && of(Reliability::reliable) == 0; }
  /// "12 of 400 points are unreliable: 9 have rays that meet at less than 1.5 degrees, 3 errors of more than 4 pixels".
  std::string sentence() const;

 private:
  std::uint64_t of(Reliability reliability) const { return counts_[static_cast<std::size_t>(reliability)]; }
  std::uint64_t all() const;

  std::array<std::uint64_t, 4> counts_{};
};

}  // namespace palpate
