#include "haptics/sharing/hand_balls.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::sharing {

namespace {

constexpr double kSpeedDecay_s = 2;   // time constant of the decay of a speed
constexpr double kShortest_s = 1e-3;  // minimum time between two positions that define a speed

}  // namespace

Ball HandBalls::ballOf(Hand& hand, const HandReach& reach, double steady_s, double trip_s) const {
  if (!hand.last_s || steady_s < *hand.last_s) hand = {.last = reach.hip, .last_s = steady_s};
  const double since_s = steady_s - *hand.last_s;
  if (since_s >= kShortest_s) {
    hand.speed =
        std::max(hand.speed * std::exp(-since_s / kSpeedDecay_s), glm::distance(reach.hip, hand.last) / since_s);
    hand.last = reach.hip;
    hand.last_s = steady_s;
  }
  // Lost samples are received one trip later, and a new ball waits for the next request.
  constexpr double kTrips = 2, kSlack_s = 0.15;
  const double ahead = std::max(hand.speed, leastSpeed_) * (kTrips * trip_s + kSlack_s);
  return {.center = 0.5 * (reach.low + reach.high),
          .radius = 0.5 * glm::distance(reach.low, reach.high) + ahead + edge_};
}

const std::vector<Ball>& HandBalls::around(const HandReaches& hands, double trip_s) {
  const double most = kMaxReach_edges * edge_;
  balls_.resize(hands.count);
  for (std::uint32_t i = 0; i < hands.count; ++i) {
    Ball next = ballOf(hands_[i], hands.hands[i], hands.steady_s, trip_s);
    next.radius = std::min(next.radius, most);
    // Each new ball costs the server work.
    const Ball& before = balls_[i];
    constexpr double kMoved = 0.5, kGrown = 1.1, kShrunk = 0.5;
    const bool stays = glm::distance(next.center, before.center) < kMoved * edge_ &&
                       next.radius <= before.radius * kGrown && next.radius >= before.radius * kShrunk;
    if (!stays) balls_[i] = next;
  }
  return balls_;
}

}  // namespace palpate::sharing
