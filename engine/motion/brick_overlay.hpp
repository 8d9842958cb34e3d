// What a hand has made of the points of a cloud that somebody else has, over the bricks of it that have come.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/core/point_state.hpp"
#include "engine/motion/brick_grid.hpp"

namespace palpate {

/// The points of a brick, by ascending id: their numbers in the whole cloud. Relative to the cloud's origin.
struct Brick {
  std::vector<std::uint32_t> ids;
  std::vector<Vec3> positions, normals;
  std::vector<Vec3> velocities;       ///< empty where points stand still
  std::vector<std::uint32_t> colors;  ///< RGBA8, red in the lowest byte; 0: none. Empty where no point has any

  std::size_t size() const { return ids.size(); }
  bool operator==(const Brick&) const = default;
};

/// Points that are made otherwise here are so at once, and stay so, whatever comes, until it is known that what comes
/// has them in it (settle()). One thread uses it at a time.
class BrickOverlay {
 public:
  explicit BrickOverlay(const BrickGrid& grid) : grid_(grid) {}

  // Of who has the whole cloud.
  void come(BrickKey key, std::shared_ptr<const Brick> brick);
  void drop(BrickKey key);
  /// All that has come is known no more; what was made here stays.
  void forget();
  /// What became of these points is in what has come: what was made of them here since takeMade() told of it alone
  /// stays.
  void settle(std::span<const std::uint32_t> points);

  // Of the hand.
  /// `from`: as the point was here before.
  void make(std::span<const PointChange> changes);
  /// Appends what was made since the last call: each point once, as it was made last, those first that were made first.
  void takeMade(std::vector<PointState>& states);
  bool allTaken() const { return made_.empty(); }
  /// Points of which what comes is not shown.
  std::size_t own() const { return own_.size(); }

  /// Bricks that may be others than at the last call.
  std::set<BrickKey> takeTouched();
  /// A brick as it is with what was made here; null where none has come.
  std::shared_ptr<const Brick> shown(BrickKey key) const;

 private:
  struct Own {
    PointState state;
    BrickKey came = 0;   // the last brick that came with the point in it
    bool isNew = false;  // it was made since takeMade()
  };
  BrickKey keyOf(const PointState& state) const { return grid_.keyAt(DVec3(state.position)); }
  BrickKey cameIn(std::uint32_t point, BrickKey where) const;
  void stand(const PointState& state);
  void leave(const PointState& state);

  BrickGrid grid_;
  std::map<BrickKey, std::shared_ptr<const Brick>> come_;
  std::unordered_map<std::uint32_t, Own> own_;
  std::map<BrickKey, std::set<std::uint32_t>> standing_;  // of own_, those that are there, by brick
  std::vector<std::uint32_t> made_;                       // since takeMade(), in order
  std::set<BrickKey> touched_;
};

}  // namespace palpate
