// A hand in matter that is simulated elsewhere, over a link with a given delay: the remote simulation, the messages in
// both directions, and the pond that the hand feels.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "engine/matter/matter_pond.hpp"
#include "tests/matter/matter_scenes.hpp"

namespace palpate {

class FarMatter {
 public:
  /// `delay_s`: in each direction.
  FarMatter(const MatterScene& scene, double delay_s)
      : delay_s_(delay_s),
        there_(scene, {.threads = 1, .tools = 1}),
        here_(scene, {.threads = 1, .tools = 1}, [this](KnownMatter& known) { return takeNews(known); }) {}

  /// A step of both simulations. The hand's pose and the frames are sent every 16 steps.
  void step(const HandPose& hand) {
    const double now_s = static_cast<double>(steps_) * kMatterStep_s;
    if (steps_ % kApart == 0) heard_.push_back({now_s + delay_s_, hand});
    while (!heard_.empty() && heard_.front().at_s <= now_s) {
      if (!known_) place(heard_.front().hand);
      known_ = heard_.front().hand;
      heard_.pop_front();
    }
    if (known_) at_.place_m += (known_->place_m - at_.place_m) * (1 - std::exp(-kMatterStep_s / kBetweenPlaces_s));
    there_.step({&at_, 1});
    if (steps_ % kApart == 0) sent_.push_back({now_s, there_.positionsById(), there_.velocitiesById()});
    here_.step({&hand, 1});
    ++steps_;
  }
  /// Reverses the order of the remote particles from the next news on, as after a restart of the simulation.
  void collapse() { isTurned_ = !isTurned_; }
  /// Stops receiving news.
  void hold(bool held) { isHeld_ = held; }

  MatterWorld& there() { return there_; }
  MatterPond& here() { return here_; }
  const ToolAnswer& felt() const { return here_.answers()[0]; }

 private:
  static constexpr std::uint64_t kApart = 16;
  static constexpr double kBetweenPlaces_s = 0.02;
  struct Heard {
    double at_s = 0;
    HandPose hand;
  };
  struct Sent {
    double at_s = 0;
    std::vector<Vec3> places, velocities;
  };

  void place(const HandPose& hand) {
    at_ = hand;
    there_.placeTool(0);
  }
  bool takeNews(KnownMatter& known) {
    const double now_s = static_cast<double>(steps_) * kMatterStep_s;
    bool isNew = false;
    for (; !isHeld_ && !sent_.empty() && sent_.front().at_s + delay_s_ <= now_s; sent_.pop_front()) {
      known = {.positions = sent_.front().places, .velocities = sent_.front().velocities, .time_s = sent_.front().at_s};
      if (isTurned_) {
        std::ranges::reverse(known.positions);
        std::ranges::reverse(known.velocities);
      }
      known.ids.resize(known.positions.size());
      std::iota(known.ids.begin(), known.ids.end(), 0u);
      isNew = true;
    }
    return isNew;
  }

  double delay_s_;
  std::uint64_t steps_ = 0;
  std::deque<Heard> heard_;
  std::optional<HandPose> known_;  // the hand's last pose received there
  HandPose at_{.place_m = DVec3(0, 100, 0)};
  std::deque<Sent> sent_;
  bool isHeld_ = false, isTurned_ = false;
  MatterWorld there_;
  MatterPond here_;
};

}  // namespace palpate
