// A client's own edits on top of the bricks of a store.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/cloud/point_store.hpp"
#include "engine/core/point_state.hpp"
#include "haptics/sharing/point_digest.hpp"

namespace palpate {

/// Points edited here take effect at once and override received data until the server confirms that its data contains
/// the edits (settle()). For one thread at a time.
class BrickOverlay {
 public:
  explicit BrickOverlay(const BrickGrid& grid) : grid_(grid) {}

  using Bricks = std::map<BrickKey, std::shared_ptr<const Brick>>;

  /// The store has other points of a brick, or has dropped it (null).
  void come(BrickKey key, const Brick* brick);
  /// The received bricks contain the edits of these points: only edits made since the last takeMade() stay.
  void settle(std::span<const std::uint32_t> points);

  // Local edits.
  enum class Replaces {
    any,   ///< whatever others make of the points meanwhile
    known  ///< only the state that they change from: points that others have changed stay as these made them
  };
  /// `from`: the point's local state before the edit. `shown`: the bricks as shown() last.
  void make(std::span<const PointChange> changes, const Bricks& shown, Replaces replaces);
  /// Appends the points edited since the last call: each point once, in its latest state, in the order of their first
  /// edit.
  void takeMade(std::vector<sharing::MadeState>& states);
  bool allTaken() const { return made_.empty(); }
  /// Number of points whose local state overrides the received one.
  std::size_t own() const { return own_.size(); }

  /// Bricks that may have changed since the last call.
  std::set<BrickKey> takeTouched();
  /// A brick of the store with the local edits applied; null if the store does not have it.
  std::shared_ptr<const Brick> shown(BrickKey key, std::shared_ptr<const Brick> stored) const;

 private:
  struct Own {
    sharing::MadeState made;
    BrickKey came = 0;   // last brick of the store that contained the point
    bool isNew = false;  // edited since takeMade()
  };
  BrickKey keyOf(const PointState& state) const { return grid_.keyAt(DVec3(state.position)); }
  static BrickKey cameIn(std::uint32_t point, BrickKey where, const Bricks& shown);
  void stand(const PointState& state);
  void leave(const PointState& state);

  BrickGrid grid_;
  std::unordered_map<std::uint32_t, Own> own_;
  std::map<BrickKey, std::set<std::uint32_t>> standing_;  // points of own_ that exist, by brick
  std::vector<std::uint32_t> made_;                       // since takeMade(), in order
  std::set<BrickKey> touched_;
};

}  // namespace palpate
