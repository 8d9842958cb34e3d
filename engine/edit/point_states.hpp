#pragma once

#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_set.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// The present states of the points of an edited cloud: of all, by number, new points after the file's; or, of a cloud
/// of which only a part is known, of those that were set, in that order. 48 bytes a point. Passes as a
/// std::span<const PointState>, of a whole cloud to what needs all points.
class PointStates {
 public:
  /// Of a cloud of which no point is known yet.
  PointStates() : index_(std::in_place) {}
  /// `file`: the cloud before the first edit.
  explicit PointStates(const PointCloud& file);

  /// Replaces the states of these points, in order; points that were not known before are added.
  void set(std::span<const PointState> states) {
    for (const PointState& state : states) set(state);
  }
  void set(const PointState& state) {
    const std::size_t at = indexOf(state.number);
    if (at >= states_.size()) grow(state.number);
    PointState& point = states_[at];
    present_ += point.gone;
    present_ -= state.gone;
    point = state;
  }

  /// Points that existed vanish, and those that did not reappear, in nothing else changed. All are known.
  void flip(const PointSet& points);

  /// Exchanges these states, each of another known point, with the present ones.
  void exchange(std::span<PointState> states);

  /// A point that was never set does not exist (PointState::gone()).
  PointState operator[](std::uint64_t point) const {
    const std::size_t at = indexOf(point);
    return at < states_.size() ? states_[at] : never(point);
  }
  /// Index of a point's state; that of a point that was not set is where set() puts it, at size() or behind.
  std::size_t indexOf(std::uint64_t point) const {
    if (!index_) return point;
    const auto there = index_->find(point);
    return there == index_->end() ? states_.size() : there->second;
  }
  /// Always true of a whole cloud, whose other points do not exist.
  bool knows(std::uint64_t point) const { return !index_ || index_->contains(point); }
  /// Number of states, including those of removed points.
  std::size_t size() const { return states_.size(); }
  /// Includes all points that are not in the file.
  std::span<const PointState> added() const { return std::span(states_).subspan(file_); }
  const PointState* begin() const { return states_.data(); }
  const PointState* end() const { return begin() + size(); }
  /// Number of existing points.
  std::size_t present() const { return present_; }

 private:
  static PointState never(std::uint64_t point) { return {.gone = true, .number = point, .parent = point}; }
  void grow(std::uint64_t point);

  std::vector<PointState> states_;
  std::optional<std::unordered_map<std::uint64_t, std::size_t>> index_;  // by number; of a part alone
  std::size_t present_ = 0, file_ = 0;  // file_: states of a whole cloud before those of new points
};

}  // namespace palpate
