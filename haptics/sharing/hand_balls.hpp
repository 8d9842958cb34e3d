// How far ahead of a hand its points are asked for. Nothing of DDS is seen here.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/motion/brick_source.hpp"
#include "haptics/sharing/brick_ledger.hpp"

namespace palpate::sharing {

/// The ball around each hand in which it may feel until what is asked for now has come: its speed times that, and what
/// its surface is made of now. A hand that rests may set out at any moment.
class HandBalls {
 public:
  /// `leastSpeed`: of a hand that is thought to set out, model units per second.
  HandBalls(double edge, double leastSpeed) : edge_(edge), leastSpeed_(leastSpeed) {}
  /// `trip_s`: from a question to its answer. The balls of before where the hands are still well within.
  const std::vector<Ball>& around(const HandReaches& hands, double trip_s);

 private:
  struct Hand {
    DVec3 last{0};
    std::optional<double> last_s;
    double speed = 0;  // its highest one, which is forgotten little by little
  };
  Ball ballOf(Hand& hand, const HandReach& reach, double steady_s, double trip_s) const;

  double edge_, leastSpeed_;
  std::array<Hand, kMaxHands> hands_;
  std::vector<Ball> balls_;
};

}  // namespace palpate::sharing
