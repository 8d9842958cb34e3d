#include "engine/matter/matter_steps.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace palpate {

MatterSteps::MatterSteps(std::unique_ptr<MatterSimulation> simulation, std::size_t tools, std::uint32_t mostAtOnce)
    : SteppedControl(*simulation, tools, mostAtOnce), world_(std::move(simulation)), tools_(tools), between_(tools) {}

void MatterSteps::restart() {
  world_->reset();
  hands_.clear();
  forget();
}

// The ball of a repositioned hand is placed, not moved.
void MatterSteps::place(const MatterQuestion& question) {
  for (std::size_t i = 0; i < tools_; ++i) {
    if (putDown_[i] == question.putDown[i]) continue;
    putDown_[i] = question.putDown[i];
    hands_[i] = question.hands[i];
    world_->placeTool(i);
  }
}

MatterAnswer MatterSteps::goTo(const MatterQuestion& question) {
  const std::span<const HandPose> hands(question.hands.data(), tools_);
  const std::int64_t now = std::llround(question.time_s / kMatterStep_s);
  if (takeReset() || goesBack(now)) restart();
  takeParameters(*world_);
  const bool held = isPaused();
  const std::uint32_t steps = stepsTo(now, 1);
  // A hand that moves while the simulation is paused resumes at its new pose.
  if (hands_.empty() || held) hands_.assign(hands.begin(), hands.end());
  place(question);
  for (std::uint32_t k = 0; k < steps && !held; ++k) {
    const double share = (k + 1.0) / steps;
    for (std::size_t i = 0; i < tools_; ++i)
      between_[i] = {.place_m = glm::mix(hands_[i].place_m, hands[i].place_m, share),
                     .orientation = glm::slerp(hands_[i].orientation, hands[i].orientation, share),
                     .felt = hands[i].felt};
    world_->step(between_);
    for (std::size_t i = 0; i < tools_; ++i) seeEnergy(i, world_->portEnergy_J(i));
  }
  if (!held) hands_.assign(hands.begin(), hands.end());
  see(world_->state());
  MatterAnswer answer{.question = question, .moves = !held, .state = world_->state(), .hands = {}};
  std::ranges::copy(world_->answers(), answer.hands.begin());
  if (steps > 0 && !held) unshown_s_ = question.time_s;
  if (steps > 0 && wanted_.load(std::memory_order_relaxed)) show(question.time_s);
  return answer;
}

MatterAnswer MatterSteps::answerTo(const MatterQuestion& question) noexcept {
  if (!faulty_.load()) {
    try {
      return goTo(question);
    } catch (...) {
      fault_ = std::current_exception();
      faulty_.store(true);
    }
  }
  return {.question = question, .moves = false, .state = MatterState::diverged, .hands = {}};
}

void MatterSteps::throwFault() const {
  if (faulty_.load()) std::rethrow_exception(fault_);
}

void MatterSteps::show(double time_s) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;  // it is being taken; the next step is shown
  positions_ = world_->positionsById();
  velocities_ = world_->velocitiesById();
  shownAt_s_ = time_s;
  unshown_s_.reset();
  wanted_.store(false, std::memory_order_relaxed);
}

void MatterSteps::showPresent() {
  if (unshown_s_) show(*unshown_s_);
}

bool MatterSteps::take(MatterView& view) {
  const std::lock_guard lock(mutex_);
  wanted_.store(true, std::memory_order_relaxed);
  if (!shownAt_s_) return false;
  view.time_s = *shownAt_s_;
  view.positions.swap(positions_);
  view.velocities.swap(velocities_);
  shownAt_s_.reset();
  return true;
}

}  // namespace palpate
