// A cloud of which only the bricks around the hands are here: what has come of them is a source of frames.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "engine/core/latest_value.hpp"
#include "engine/motion/brick_overlay.hpp"
#include "engine/motion/cloud_source.hpp"

namespace palpate {

/// What changes at once of what is known.
struct BrickUpdate {
  double true_s = 0;              ///< of points that move: when all known bricks are where they are now (steadyNow_s())
  bool whole = false;             ///< nothing else is to come of what was asked for
  std::vector<BrickKey> dropped;  ///< not known any more
  std::vector<std::pair<BrickKey, std::shared_ptr<const Brick>>> bricks;  ///< are this now
  std::vector<std::uint32_t> settled;  ///< points that were made otherwise here: this has what has become of that
};

/// Ticks, and those at which the surface may be made of points that are not known.
struct UnknownTicks {
  std::uint64_t ticks = 0, without = 0;
};

/// A clock that only goes on, for times that are taken on several threads.
double steadyNow_s();

/// Where the points have to be known for one hand. Relative to the cloud's origin, but for what says otherwise.
struct HandReach {
  DVec3 low{0}, high{0};   ///< box of all that the surface may be made of at this tick
  DVec3 hip{0}, proxy{0};  ///< file coordinates, at the last tick
  bool touching = false;
};
struct HandReaches {
  double time_s = 0;    ///< of the session
  double steady_s = 0;  ///< when they were there
  std::uint32_t count = 0;
  bool sculpts = false;  ///< the first one has a brush
  std::array<HandReach, kMaxHands> hands{};
};

/// Bricks as they have come, in frames: the points of all known bricks in the order of the whole cloud, so that sums
/// over neighbours are those of whoever has all of it, bit by bit. The number of a point in a frame is its place there.
/// What apply() brings is in the next frame. ask(), covers() and await() are for one thread, makeFrame() and hasNewer()
/// for another one, the rest for any.
class BrickSource final : public CloudSource {
 public:
  /// Room for so many points.
  struct Options {
    double edge = 1;         ///< of a brick, model units
    std::size_t points = 1;  ///< that are known at once, at most
    bool moves = false;      ///< their frames are true for the times of their updates, and not for any
    bool colored = false;    ///< their frames have colours
  };
  explicit BrickSource(const Options& options) : options_(options), grid_(options.edge), overlay_(grid_) {}
  const BrickGrid& grid() const { return grid_; }
  bool moves() const { return options_.moves; }
  bool isColored() const { return options_.colored; }

  /// Where the hands are. Allocates nothing and waits for nobody.
  void ask(const HandReaches& hands) noexcept { asked_.store(hands); }
  std::optional<HandReaches> asked() const noexcept { return asked_.load(); }

  /// Whether all bricks that the box reaches are in the frame that is true for `frame_s`, of the last ones that were
  /// made.
  bool covers(double frame_s, const DVec3& low, const DVec3& high) const noexcept;
  /// Waits until all bricks that each of the hands reaches are known, at most so long. What is known then is what the
  /// frame for the hands' time has, whatever comes or goes meanwhile.
  bool await(const HandReaches& hands, double patience_s);
  /// Waits for the same, and for all around it that `wide` reaches, as far as there is room for that.
  bool await(const HandReaches& hands, const HandReaches& wide, double patience_s);

  /// Whether a brick that a hand reaches (ask()) has other points now than it was known to have. Throws Error for more
  /// points than there is room for.
  bool apply(BrickUpdate update);
  /// Nothing is known any more.
  void forget();

  // What a hand here makes of points that stand still: it is so in the frames that are made from then on.
  /// Appends the points of a box, relative to the cloud's origin, as they are now.
  void pointsIn(const DVec3& low, const DVec3& high, std::vector<PointState>& points) const;
  /// Gives the version that frames have with it. Throws Error for more points than there is room for.
  std::uint64_t make(std::span<const PointChange> changes);
  /// BrickOverlay::takeMade().
  void takeMade(std::vector<PointState>& states);
  /// Of the frame that is true for `frame_s`, of the last ones that were made; 0: it is none of those.
  std::uint64_t versionOf(double frame_s) const noexcept;
  /// From now on await() waits for nobody, and says no.
  void giveUp();
  struct Known {
    std::size_t bricks = 0, points = 0;
    std::size_t own = 0;   ///< points that are as a hand here has made them
    bool allTaken = true;  ///< nothing was made since takeMade()
  };
  Known known() const;

  std::size_t size() const override { return options_.points; }
  bool keepsPoints() const override { return false; }
  void makeFrame(double time_s, CloudFrame& frame) override;
  /// The points of the frame that was made last, by their numbers in the whole cloud. For the thread that makes frames.
  std::vector<std::uint32_t> ids() const;
  bool hasNewer(double time_s, double than_s) override;

 private:
  // What a frame had, for covers(). Of three the one that is made last is neither felt nor the one before it.
  struct Made {
    std::atomic<double> time_s = -1;
    std::uint64_t version = 0;
    std::vector<BrickKey> keys;
  };
  using Bricks = std::map<BrickKey, std::shared_ptr<const Brick>>;
  struct State {
    Bricks bricks;
    double true_s = 0;
    std::uint64_t version = 0;
  };
  bool knows(const HandReaches& hands) const;
  bool isReached(const HandReaches& hands, BrickKey key) const;
  bool compose();
  const Made* madeFor(double frame_s) const noexcept;
  const State& stateFor(double time_s) const { return awaitedFor_s_ == time_s ? awaited_ : now_; }
  double frameTime(double time_s, double true_s);

  Options options_;
  BrickGrid grid_;
  LatestValue<HandReaches> asked_;

  mutable std::mutex lock_;  // of these
  std::condition_variable came_;
  State now_{.version = 1};
  std::size_t points_ = 0;
  BrickOverlay overlay_;
  State awaited_;
  std::optional<double> awaitedFor_s_;
  bool isWhole_ = false, isOver_ = false;

  // Of the thread that makes frames.
  std::uint64_t made_ = 0;
  std::vector<std::shared_ptr<const Brick>> taken_;
  std::vector<std::pair<std::uint32_t, std::uint64_t>> order_;  // id; which brick, and which point of it
  std::optional<double> lastTime_s_, toSession_s_;
  std::uint64_t frames_ = 0;
  std::array<Made, 3> frame_;
};

}  // namespace palpate
