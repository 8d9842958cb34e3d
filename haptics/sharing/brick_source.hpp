// A cloud of which only the bricks around the hands are present: the bricks of a store are a source of frames.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/point_store.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/latest_value.hpp"
#include "engine/motion/cloud_source.hpp"
#include "haptics/sharing/brick_overlay.hpp"
#include "haptics/sharing/followed_points.hpp"

namespace palpate {

/// The blocks that a client has received from its server, as a store of points.
/// Bricks come as the link requests them, which knows what its BrickSource lacks.
class ReceivedBricks final : public PointStore {
 public:
  explicit ReceivedBricks(const BrickGrid& grid) : grid_(grid) {}

  /// `block`: with the checksum of its sender.
  void receive(BrickKey key, PointBlock block) {
    block.version = ++version_;
    blocks_[key] = std::move(block);
    news_.insert(key);
  }
  void drop(BrickKey key) {
    if (blocks_.erase(key) > 0) news_.insert(key);
  }
  void clear() {
    for (const auto& [key, block] : blocks_) news_.insert(key);
    blocks_.clear();
  }

  const BrickGrid& grid() const override { return grid_; }
  void want(std::span<const BrickKey>) override {}
  std::optional<PointBlock> get(BrickKey key) const override {
    const auto there = blocks_.find(key);
    return there == blocks_.end() ? std::nullopt : std::optional(there->second);
  }
  void takeNews(std::vector<BrickKey>& keys) override {
    keys.insert(keys.end(), news_.begin(), news_.end());
    news_.clear();
  }
  void refuse(BrickKey key) override {
    blocks_.erase(key);
    isRefused_ = true;
  }
  /// Blocks were refused since the last call: they have to be requested again.
  bool takeRefused() { return std::exchange(isRefused_, false); }

 private:
  BrickGrid grid_;
  std::map<BrickKey, PointBlock> blocks_;
  std::set<BrickKey> news_;
  std::uint64_t version_ = 0;
  bool isRefused_ = false;
};

/// Changes that are applied together.
struct BrickUpdate {
  double true_s = 0;              ///< for moving points: steadyNow_s() of the positions of all known bricks
  bool whole = false;             ///< nothing requested is still to be received
  std::vector<BrickKey> dropped;  ///< no longer known
  std::vector<std::pair<BrickKey, PointBlock>> bricks;  ///< new contents, with the checksums of the server
  std::vector<std::uint32_t> settled;                   ///< points edited here whose edits this update contains
  std::array<Vec3, kMaxHands> force_N{};                ///< of simulated matter on the hands here
};

/// Forces of matter that the server simulates on the hands here.
struct HandForces {
  double true_s = 0;  ///< as BrickUpdate::true_s
  std::array<Vec3, kMaxHands> force_N{};
};

/// A monotonic clock, for times that are compared across threads.
double steadyNow_s();

/// Region in which one hand needs the points; relative to the cloud's origin unless stated otherwise.
struct HandReach {
  DVec3 low{0}, high{0};   ///< box of all points that may contribute to the surface at this tick
  DVec3 hip{0}, proxy{0};  ///< file coordinates, at the last tick
  bool touching = false;
};
struct HandReaches {
  double time_s = 0;    ///< session time
  double steady_s = 0;  ///< steadyNow_s() at the same moment
  std::uint32_t count = 0;
  bool sculpts = false;  ///< the first hand has a brush
  std::array<HandReach, kMaxHands> hands{};
};

/// The bricks of a store as frames: the points of all known bricks in the order of the whole cloud, so that sums over
/// neighbours equal those over the whole cloud, bit by bit. A point's number in a frame is its index there. A brick
/// whose checksum does not fit its points counts as missing and is requested again, and after a few times it is named
/// (takeSaid()).
/// The next frame contains the changes of apply() and of the store. ask(), covers() and await() are for one thread,
/// makeFrame() and hasNewer() for another one, all other functions for any thread.
class BrickSource final : public CloudSource {
 public:
  /// Memory is reserved for `points` points.
  struct Options {
    double edge = 1;         ///< of a brick, model units; of received ones alone
    std::size_t points = 1;  ///< maximum number of points known at once
    bool moves = false;      ///< frames are true for the times of their updates only
    bool colored = false;    ///< their frames have colours
  };
  /// Of bricks that are received by apply().
  explicit BrickSource(const Options& options) : BrickSource(options, nullptr) {}
  /// Of the bricks of a store, which must outlive it, and which it alone uses.
  BrickSource(const Options& options, PointStore& store) : BrickSource(options, &store) {}
  const BrickGrid& grid() const { return grid_; }
  bool moves() const { return options_.moves; }
  bool isColored() const { return options_.colored; }

  /// Sets the positions of the hands. Does not allocate or block.
  void ask(const HandReaches& hands) noexcept { asked_.store(hands); }
  std::optional<HandReaches> asked() const noexcept { return asked_.load(); }
  /// Forces of the last update; does not block. Nothing while they are replaced.
  std::optional<HandForces> forces() const noexcept { return forces_.load(); }

  /// Whether the frame that is true for `frame_s`, one of the last ones made, contains all bricks that the box reaches.
  bool covers(double frame_s, const DVec3& low, const DVec3& high) const noexcept;
  /// Waits up to `timeout_s` until all bricks that the hands reach are known. The frame for the hands' time has the
  /// bricks known then, whatever is received or dropped meanwhile.
  bool await(const HandReaches& hands, double timeout_s);
  /// Also waits for the bricks that `wide` reaches, as far as there is memory for them.
  bool await(const HandReaches& hands, const HandReaches& wide, double timeout_s);

  /// Returns whether a brick that a hand reaches (ask()) has changed points. Throws Error if the points exceed the
  /// reserved memory.
  bool apply(BrickUpdate update);
  /// Discards all known bricks.
  void forget();

  /// Messages about damaged bricks since the last call.
  std::vector<std::string> takeSaid();
  /// Damaged bricks of apply() since the last call have to be requested again.
  bool takeRefused();

  // Local edits of points that do not move: frames made after an edit contain it.
  /// Appends the current points of a box relative to the cloud's origin.
  void pointsIn(const DVec3& low, const DVec3& high, std::vector<PointState>& points) const;
  /// All points that are known, by number, which is a field of its own.
  PointCloud cloud() const;
  /// An edit of the stroke of that number. Returns the version of frames that contain it. Throws Error if the points
  /// exceed the reserved memory.
  std::uint64_t make(std::span<const PointChange> changes, std::uint32_t stroke = 0);
  /// From now on the edits are kept for takeEdits().
  void keepEdits();
  /// EditStream::take(): with the state of each point before its first edit, and what others make of it later.
  void takeEdits(EditBatch& batch);
  void endStroke();
  /// Sets points as EditStream::change() does, of kept edits. Points that others have changed stay as they are, and are
  /// reported as received: at once, as far as that is known here, or when the server has refused the change. Returns as
  /// make().
  std::uint64_t change(std::span<const PointChange> changes);
  /// BrickOverlay::takeMade().
  void takeMade(std::vector<sharing::MadeState>& states);
  /// Version of the frame that is true for `frame_s`, one of the last ones made; 0: it is not one of those.
  std::uint64_t versionOf(double frame_s) const noexcept;
  /// From now on await() does not block, and returns false unless the bricks are known.
  void giveUp();
  struct Known {
    std::size_t bricks = 0, points = 0;
    std::size_t own = 0;   ///< points whose local state overrides the received one
    bool allTaken = true;  ///< no edits since takeMade()
  };
  Known known() const;

  std::size_t size() const override { return options_.points; }
  bool keepsPoints() const override { return false; }
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

 private:
  // Contents of a frame, for covers(). Three frames: the one being made is neither the one in use nor its predecessor.
  struct Made {
    std::atomic<double> time_s = -1;
    std::uint64_t version = 0;
    std::vector<BrickKey> keys;
  };
  struct State {
    BrickOverlay::Bricks bricks;
    double true_s = 0;
    std::uint64_t version = 0;
  };
  BrickSource(const Options& options, PointStore* store)
      : options_(options),
        grid_(store ? store->grid() : BrickGrid(options.edge)),
        received_(grid_),
        store_(store ? *store : received_),
        overlay_(grid_),
        followed_(grid_) {}
  bool knows(const HandReaches& hands) const;
  bool isReached(const HandReaches& hands, BrickKey key) const;
  void want(const HandReaches& hands);
  void take(BrickKey key);
  std::shared_ptr<const Brick> stored(BrickKey key) const;
  void takeNews();
  enum class From { here, store };
  bool compose(From changes);
  const Made* madeFor(double frame_s) const noexcept;
  const State& stateFor(double time_s) const { return awaitedFor_s_ == time_s ? awaited_ : now_; }
  double frameTime(double time_s, double true_s);

  Options options_;
  BrickGrid grid_;
  LatestValue<HandReaches> asked_;
  LatestValue<HandForces> forces_;

  mutable std::mutex lock_;  // guards the members up to isOver_
  std::condition_variable came_;
  ReceivedBricks received_;
  PointStore& store_;
  std::vector<BrickKey> wanted_, news_;  // of the store: what the hands reach
  std::map<BrickKey, int> damaged_;      // bricks that count as missing: times in a row that they were damaged
  std::vector<std::string> said_;
  State now_{.version = 1};
  std::size_t points_ = 0;
  BrickOverlay overlay_;
  FollowedPoints followed_;
  State awaited_;
  std::optional<double> awaitedFor_s_;
  bool isWhole_ = false, isOver_ = false;

  // For the thread that makes frames.
  std::uint64_t made_ = 0;
  std::vector<std::shared_ptr<const Brick>> taken_;
  std::vector<std::pair<std::uint32_t, std::uint64_t>> order_;  // id; index of its brick, and of the point in it
  std::optional<double> lastTime_s_, toSession_s_;
  std::uint64_t frames_ = 0;
  std::array<Made, 3> frame_;
};

}  // namespace palpate
