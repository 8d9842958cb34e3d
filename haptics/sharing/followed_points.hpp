// The edits of hands near their points, for a history, a log and other followers.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/cloud/point_store.hpp"
#include "engine/core/edit_batch.hpp"

namespace palpate {

/// Follows the points that hands here have edited: what hands here make of them, and what others do. The state of a
/// point before its first edit is reported first, as received, as a follower knows no point. For one thread at a time.
class FollowedPoints {
 public:
  explicit FollowedPoints(const BrickGrid& grid) : grid_(grid) {}
  /// Follows from now on.
  void keep() { keeps_ = true; }

  /// An edit of the stroke of that number; another number ends the stroke in progress.
  void edited(std::span<const PointChange> changes, std::uint32_t stroke);
  void endStroke();
  /// EditStream::change(): ends the stroke. `changes`: those that stand().
  void changed(std::span<const PointChange> changes);
  /// The point is as `state` for all that is known here, and is followed.
  bool stands(const PointState& state) const;

  /// A brick is shown with these points, edits of hands here included.
  void show(BrickKey key, const Brick& brick);
  /// All bricks of a step were shown: reports the points that others have changed. A point that is in none of them any
  /// more was removed, or moved to where it is not known: it is reported as removed.
  void endStep();

  /// EditStream::take().
  void take(EditBatch& batch);

 private:
  void set(const PointState& state);
  void mark(EditMark::Kind kind) { batch_.marks.push_back({batch_.points.size(), kind}); }
  void receive(std::span<const PointState> states);
  BrickKey keyOf(const PointState& state) const { return grid_.keyAt(DVec3(state.position)); }

  BrickGrid grid_;
  bool keeps_ = false, inStroke_ = false;
  std::uint32_t stroke_ = 0;
  std::unordered_map<std::uint64_t, PointState> states_;                      // as reported last
  std::unordered_map<BrickKey, std::unordered_set<std::uint64_t>> standing_;  // those that exist, by brick
  std::vector<PointState> others_;                           // of the step, as others have changed them
  std::vector<std::pair<BrickKey, std::uint64_t>> missing_;  // of the step: points, with their bricks
  EditBatch batch_;
};

}  // namespace palpate
