// The viewer walks while keys are held.
#pragma once

#include <array>

#include "apps/view/commands.hpp"
#include "apps/view/viewpoint.hpp"

namespace palpate {

class Walk {
 public:
  void hold(const WalkCommand& command) { held_[static_cast<std::size_t>(command.direction)] = command.on; }
  void stop() { held_ = {}; }
  bool isWalking() const { return std::ranges::find(held_, true) != held_.end(); }
  /// Called once per frame. `isFast`: five times as fast; `longestSide`: of the model.
  void advance(double dt_s, bool isFast, double longestSide, Viewpoint& viewpoint) const;

 private:
  std::array<bool, kWalkDirections> held_{};
};

}  // namespace palpate
