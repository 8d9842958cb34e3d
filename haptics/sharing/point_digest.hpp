// A number that tells clouds apart and follows each point's changes at their cost.
#pragma once

#include <span>

#include "engine/core/checksum.hpp"
#include "engine/core/point_state.hpp"

namespace palpate::sharing {

/// Of all points, in whichever order: their sum, so that what a point was can be taken out and what it is put in.
class PointDigest {
 public:
  PointDigest() = default;
  explicit PointDigest(std::span<const PointState> points) {
    for (const PointState& point : points) sum_ += of(point);
  }
  void replace(const PointState& was, const PointState& is) { sum_ += of(is) - of(was); }
  std::uint64_t value() const { return sum_; }

 private:
  // Of a point that is not there nothing but that.
  static std::uint64_t of(const PointState& point) {
    Checksum sum;
    sum.addValue(point.id);
    if (!point.gone()) {
      for (int axis = 0; axis < 3; ++axis) sum.addValue(point.position[axis]);
      for (int axis = 0; axis < 3; ++axis) sum.addValue(point.normal[axis]);
      sum.addValue(point.color);
    }
    return sum.value();
  }
  std::uint64_t sum_ = 0;
};

}  // namespace palpate::sharing
