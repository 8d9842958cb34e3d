// What a client with only the points around its hands gets: bricks, step by step, and forces on its hands.
#pragma once

#include <optional>
#include <vector>

#include "haptics/sharing/brick_ledger.hpp"
#include "haptics/sharing/client_stream.hpp"
#include "haptics/sharing/near_points.hpp"

namespace palpate::sharing {

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
