#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/core/point_set.hpp"

namespace palpate {

/// Field of bytes, or property of a file, with the weights of the points' locks. Where there is one, the mask of locked
/// points does not count. In a splat scene it is a column of the Gaussians, too.
inline constexpr std::string_view kLockField = "lock";

/// The points that brushes leave as they are, and those that they change less.
struct PointLock {
  static constexpr std::uint8_t kWhole = 255;

  PointSet points;  ///< wholly locked
  /// By number: the share of a brush's effect that a point does not get, of kWhole. Points behind the end have the
  /// weight of their parents. Empty: all are wholly locked, or free.
  std::vector<std::uint8_t> weights;

  bool empty() const { return points.empty() && weights.empty(); }
  /// The share of a change that a point does not get, 0 to 1.
  double weightOf(std::uint64_t point, std::uint64_t parent) const {
    if (points.test(point)) return 1;
    const std::uint64_t at = point < weights.size() ? point : parent;
    return at < weights.size() ? weights[at] / double{kWhole} : 0;
  }
  bool operator==(const PointLock&) const = default;
};

}  // namespace palpate
