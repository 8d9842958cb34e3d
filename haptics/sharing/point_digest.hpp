// A checksum of a cloud that is updated point by point, and edits that apply to one state of a point only.
#pragma once

#include <optional>
#include <span>

#include "engine/core/checksum.hpp"
#include "engine/core/packed_state.hpp"

namespace palpate::sharing {

/// Sum over all points, independent of their order: a point's old value is subtracted and its new one added.
class PointDigest {
 public:
  PointDigest() = default;
  explicit PointDigest(std::span<const PointState> points) {
    for (const PointState& point : points) sum_ += of(point);
  }
  void replace(const PointState& was, const PointState& is) { sum_ += of(is) - of(was); }
  std::uint64_t value() const { return sum_; }
  /// What a point contributes; a removed one only its number.
  static std::uint64_t of(const PointState& point) {
    Checksum sum;
    sum.addValue(packedState(point).id);
    if (!point.gone) {
      for (int axis = 0; axis < 3; ++axis) sum.addValue(point.position[axis]);
      for (int axis = 0; axis < 3; ++axis) sum.addValue(point.normal[axis]);
      sum.addValue(point.color);
    }
    return sum.value();
  }

 private:
  std::uint64_t sum_ = 0;
};

/// A state that a hand has made, on its way to the server.
struct MadeState {
  PointState state;
  /// PointDigest::of() the state that it replaces, and no other; empty: it replaces any.
  std::optional<std::uint64_t> replaced = {};

  /// Both are sent as one.
  void followedBy(const MadeState& later) {
    state = later.state;
    if (!later.replaced) replaced.reset();
  }
};

}  // namespace palpate::sharing
