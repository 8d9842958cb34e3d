// How far ahead of a hand its points are requested. Independent of DDS.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "haptics/sharing/brick_ledger.hpp"
#include "haptics/sharing/brick_source.hpp"

namespace palpate::sharing {

/// The ball around each hand in which it may feel until what is requested now is received: its speed times that time,
/// and what its surface consists of now. A hand at rest may start to move at any moment.
class HandBalls {
 public:
  /// `leastSpeed`: minimum speed assumed for a hand, model units per second.
  HandBalls(double edge, double leastSpeed) : edge_(edge), leastSpeed_(leastSpeed) {}
  /// `trip_s`: from request to response. Keeps a previous ball while its hand is still well within it.
  const std::vector<Ball>& around(const HandReaches& hands, double trip_s);

 private:
  struct Hand {
    DVec3 last{0};
    std::optional<double> last_s;
    double speed = 0;  // recent maximum, decays slowly
  };
  Ball ballOf(Hand& hand, const HandReach& reach, double steady_s, double trip_s) const;

  double edge_, leastSpeed_;
  std::array<Hand, kMaxHands> hands_;
  std::vector<Ball> balls_;
};

}  // namespace palpate::sharing
