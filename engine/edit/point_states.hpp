#pragma once

#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// The present states of all points of an edited cloud, by number; new points after the file's. 48 bytes a point.
/// Passes as a std::span<const PointState> to what needs the whole cloud.
class PointStates {
 public:
  /// `file`: the cloud before the first edit.
  explicit PointStates(const PointCloud& file);

  /// Replaces the states of these points, in order; points that were not known before are added.
  void set(std::span<const PointState> states) {
    for (const PointState& state : states) set(state);
  }
  void set(const PointState& state) {
    if (state.number >= states_.size()) growTo(state.number);
    PointState& point = states_[state.number];
    present_ += point.gone;
    present_ -= state.gone;
    point = state;
  }

  /// A point that was never set does not exist (PointState::gone()).
  PointState operator[](std::uint64_t point) const { return point < states_.size() ? states_[point] : never(point); }
  /// Number of states, including those of removed points.
  std::size_t size() const { return states_.size(); }
  const PointState* begin() const { return states_.data(); }
  const PointState* end() const { return begin() + size(); }
  /// Number of existing points.
  std::size_t present() const { return present_; }

 private:
  static PointState never(std::uint64_t point) { return {.gone = true, .number = point, .parent = point}; }
  void growTo(std::uint64_t point);

  std::vector<PointState> states_;
  std::size_t present_;
};

}  // namespace palpate
