#include "apps/view/script_player.hpp"

#include <algorithm>

namespace palpate {

void ScriptPlayer::passPicture(double picture_s) {
  constexpr double kLongest_s = 0.1;  // a slow machine plays a script more slowly, with the same time steps
  if (!standsStill()) time_s_ += ownClock_ ? kStep_s : std::min(kLongest_s, picture_s);
}

std::optional<TimedAction> ScriptPlayer::takeDue() {
  if (isOver() || actions_[next_].time_s > time_s_) return std::nullopt;
  return actions_[next_++];
}

bool ScriptPlayer::isAboutToPress() const {
  if (isOver() || actions_[next_].time_s > time_s_) return false;
  const auto* const event = std::get_if<WindowEvent>(&actions_[next_].action);
  const auto* const button = event ? std::get_if<ButtonEvent>(event) : nullptr;
  return button && button->down;
}

bool ScriptPlayer::lookAgain() {
  constexpr int kLooks = 20;  // frames: the control may appear soon
  if (++looks_ < kLooks) {
    --next_;
    return true;
  }
  looks_ = 0;
  return false;
}

bool ScriptPlayer::awaitAgain() {
  constexpr double kLongest_s = 60;
  if (!awaits_) awaits_.emplace();
  const bool goesOn = awaits_->elapsed_s() < kLongest_s;
  if (goesOn)
    --next_;
  else
    awaits_.reset();
  return goesOn;
}

void ScriptPlayer::pressAndRelease() {
  looks_ = 0;
  constexpr std::size_t kPictures = 4;  // one pressed; an opening panel has its final position after two more
  clickEnd_ = next_ + kPictures;
  for (std::size_t i = 0; i < kPictures; ++i) {
    TimedAction button;
    button.time_s = time_s_;
    button.action = WindowEvent(ButtonEvent{MouseButton::left, i == 0});
    actions_.insert(actions_.begin() + static_cast<std::ptrdiff_t>(next_ + i), button);
  }
}

}  // namespace palpate
