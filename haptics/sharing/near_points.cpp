#include "haptics/sharing/near_points.hpp"

#include "haptics/sharing/seen_others.hpp"

namespace palpate::sharing {

void NearPoints::show(std::shared_ptr<const CloudFrame> frame, std::span<const SeenHand> hands) {
  forces_N_.clear();
  for (const SeenHand& hand : hands)
    if (hand.force_N != DVec3(0)) forces_N_[hand.number] = hand.force_N;
  frame_ = std::move(frame);
  isOld_ = true;
}

HandsForces NearPoints::forcesOn(const Id& client) const {
  HandsForces forces{};
  for (std::uint8_t hand = 0; hand < kMaxHands; ++hand)
    if (const auto on = forces_N_.find(handNumber(client, hand)); on != forces_N_.end())
      for (int axis = 0; axis < 3; ++axis) forces[3 * hand + axis] = static_cast<float>(on->second[axis]);
  return forces;
}

double NearPoints::showDue_s() const {
  constexpr double kApart_s = 0.005;  // between two searches of a frame
  if (!frame_ || !isOld_) return kIdle_s;
  return since_ ? kApart_s - since_->elapsed_s() : 0;
}

void NearPoints::showNow(const std::unordered_set<BrickKey>& wanted) {
  since_.emplace();
  isOld_ = false;
  bricks_.show(*frame_, wanted);
}

// Applies the edits of a static cloud to its bricks.
void NearPoints::follow() {
  if (!isBuilt_) {
    isBuilt_ = true;
    place_.upTo = points_.head();
    bricks_.build(points_.points());
  }
  constexpr std::size_t kAtOnce = 4096;
  while (points_.isBehind(place_)) {
    states_.clear();
    points_.collect(place_, Id{}, kAtOnce, states_);
    for (const PointState& state : states_) bricks_.follow(state.number);
  }
}

}  // namespace palpate::sharing
