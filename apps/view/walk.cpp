#include "apps/view/walk.hpp"

#include <algorithm>

namespace palpate {

void Walk::advance(double dt_s, bool isFast, double longestSide, Viewpoint& viewpoint) const {
  if (!isWalking()) return;
  constexpr double kSpeed = 0.2, kFast = 5;  // longest sides per second
  constexpr double kLongest_s = 0.1;         // of a frame: the first one may come late
  const auto along = [&](WalkDirection ahead, WalkDirection back) {
    return (held_[static_cast<std::size_t>(ahead)] ? 1.0 : 0.0) - (held_[static_cast<std::size_t>(back)] ? 1.0 : 0.0);
  };
  const DVec3 direction(along(WalkDirection::right, WalkDirection::left), along(WalkDirection::up, WalkDirection::down),
                        along(WalkDirection::forward, WalkDirection::back));
  viewpoint.walk(std::min(dt_s, kLongest_s) * kSpeed * (isFast ? kFast : 1) * longestSide * direction);
}

}  // namespace palpate
