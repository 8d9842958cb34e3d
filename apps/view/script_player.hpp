// Plays a script: returns its actions when they are due, and provides the window's clock.
#pragma once

#include <algorithm>
#include <optional>

#include "apps/view/script.hpp"
#include "engine/core/clock.hpp"

namespace palpate {

class ScriptPlayer {
 public:
  /// Duration of a frame on the script's own clock.
  static constexpr double kStep_s = 0.05;

  /// `ownClock`: use the script's own clock instead of the wall clock. Without actions there is no script.
  ScriptPlayer(std::vector<TimedAction> actions, bool ownClock) : actions_(std::move(actions)), ownClock_(ownClock) {}

  bool isEmpty() const { return actions_.empty(); }
  bool isOver() const { return next_ >= actions_.size(); }
  bool hasOwnClock() const { return ownClock_; }
  double time_s() const { return time_s_; }
  /// The script's time, or the wall clock's without a script.
  double clock_s() const { return isEmpty() ? sinceStart_.elapsed_s() : time_s_; }
  /// Advances the clock after a frame of that duration; clicks take no script time.
  void passPicture(double picture_s);
  /// The next action, if it is due.
  std::optional<TimedAction> takeDue();
  /// Time before which all actions were taken.
  double known_s() const { return isOver() ? clock_s() : std::min(clock_s(), actions_[next_].time_s); }
  /// Whether the next action is due and is a button press.
  bool isAboutToPress() const;

  /// Whether the script continues while a model is loaded or saved.
  bool isImpatient() const { return impatient_; }
  void setImpatient(bool on) { impatient_ = on; }

  /// Repeats the last action, whose control is not shown yet. False after too many attempts.
  bool lookAgain();
  /// Repeats the last action, whose file does not exist yet; the clock is stopped. False after a minute.
  bool awaitAgain();
  /// Called when the awaited file exists.
  void hasCome() { awaits_.reset(); }
  /// Presses and releases the button before the next action, over several frames, so that the panels can react.
  void pressAndRelease();

 private:
  bool standsStill() const { return awaits_ || looks_ > 0 || next_ < clickEnd_; }

  std::vector<TimedAction> actions_;
  bool ownClock_, impatient_ = false;
  std::size_t next_ = 0, clickEnd_ = 0;
  Stopwatch sinceStart_;
  double time_s_ = 0;
  int looks_ = 0;  // failed attempts
  std::optional<Stopwatch> awaits_;
};

}  // namespace palpate
