// What a client with only the points around its hands gets: bricks, step by step, and forces on its hands.
#pragma once

#include <memory>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/shared_presence.hpp"
#include "haptics/sharing/brick_ledger.hpp"
#include "haptics/sharing/client_stream.hpp"
#include "haptics/sharing/shared_points.hpp"

namespace palpate::sharing {

/// A server's points by brick, as the clients near their hands get them: edited or moving ones, and forces.
/// Not thread-safe.
class NearPoints {
 public:
  /// `points`: of a static cloud; must outlive this. `edge`: of a brick.
  NearPoints(const SharedPoints& points, double edge, bool moves) : points_(points), bricks_(edge), moves_(moves) {}

  bool moves() const { return moves_; }
  const ServedBricks& bricks() const { return bricks_; }
  const SharedPoints& edited() const { return points_; }

  /// Current frame of moving points, and the forces on hands.
  void show(std::shared_ptr<const CloudFrame> frame, std::span<const SeenHand> hands);
  bool isShown() const { return since_.has_value(); }
  HandsForces forcesOn(const Id& client) const;
  /// Other bricks are wanted than before.
  void wantOthers() { isOld_ = true; }

  /// Brings the bricks up to date. `wanted` gives the bricks that any client wants. Returns the seconds until there may
  /// be something new.
  template <class Wanted>
  double update(Wanted&& wanted) {
    if (!moves_) {
      follow();
      return kIdle_s;
    }
    const double due_s = showDue_s();
    if (due_s > 0) return due_s;
    showNow(wanted());
    return kIdle_s;
  }

 private:
  static constexpr double kIdle_s = 0.05;
  void follow();
  double showDue_s() const;
  void showNow(const std::unordered_set<BrickKey>& wanted);

  const SharedPoints& points_;
  ServedBricks bricks_;
  bool moves_;
  SharedPoints::Place place_;  // the bricks contain the edits up to here
  bool isBuilt_ = false;
  std::vector<PointState> states_;
  // Of moving points.
  std::shared_ptr<const CloudFrame> frame_;
  bool isOld_ = false;              // the frame is new, or was searched for other bricks than those wanted now
  std::optional<Stopwatch> since_;  // the last search; empty: never shown
  std::unordered_map<std::uint32_t, DVec3> forces_N_;  // by SeenHand::number
};

class NearFeed {
 public:
  /// Maximum number of samples in flight to a client.
  static constexpr std::uint64_t kWindow = 1024;
  /// `points` must outlive it.
  NearFeed(NearPoints& points, const Id& client) : points_(points), client_(client) {}
  static bool isValid(const Want& want);

  /// Takes the balls of a request that isValid(); their bricks are looked up later.
  void take(const Want& want);
  /// Balls are waiting since then; empty: none are.
  std::optional<Stopwatch::Clock::time_point> waitsSince() const;
  void lookUp();
  std::span<const BrickKey> wanted() const { return wanted_; }

  bool next(StreamSample& sample, const ClientStream& to);
  /// Until there may be something to send that nothing here reports.
  static double due_s() { return 0.05; }
  std::uint64_t steps() const { return steps_; }

 private:
  // A step that is being sent, sample by sample.
  struct Outgoing {
    BrickLedger::Step step;
    HandsForces forces{};
    double true_s = 0;
    std::uint64_t acked = 0;
    std::size_t dropped = 0, brick = 0, point = 0;  // sent so far
  };
  bool begin(const ClientStream& to);
  void fill(StreamSample& sample);

  NearPoints& points_;
  Id client_;
  std::vector<Ball> balls_;
  std::vector<BrickKey> wanted_;            // the bricks of the balls
  std::optional<std::vector<Ball>> asked_;  // newer balls, whose bricks were not looked up yet
  Stopwatch::Clock::time_point since_;      // asked_ is pending since then
  std::uint64_t seen_ = 0;                  // version of the bricks at which nothing was left to send
  bool wantsMore_ = true;                   // its request has changed since
  std::uint64_t acked_ = 0;                 // last piece of its strokes that was acknowledged to it
  HandsForces forces_{};                    // the last ones that it was sent
  BrickLedger ledger_;
  std::optional<Outgoing> outgoing_;
  std::uint64_t steps_ = 0;
};

}  // namespace palpate::sharing
