// Which event of a script comes next, and when; and by which clock the window goes.
#pragma once

#include <optional>

#include "apps/view/script.hpp"
#include "engine/core/clock.hpp"

namespace palpate {

class ScriptPlayer {
 public:
  /// Of its own clock, in which each picture takes that long.
  static constexpr double kStep_s = 0.05;

  /// `ownClock`: it goes by that, and not by the wall's. Without actions, a person plays.
  ScriptPlayer(std::vector<TimedAction> actions, bool ownClock) : actions_(std::move(actions)), ownClock_(ownClock) {}

  bool isEmpty() const { return actions_.empty(); }
  bool isOver() const { return next_ >= actions_.size(); }
  bool hasOwnClock() const { return ownClock_; }
  double time_s() const { return time_s_; }
  /// The script's, or a person's.
  double clock_s() const { return isEmpty() ? sinceStart_.elapsed_s() : time_s_; }
  /// A picture was made, and took so long; what is clicked takes no time.
  void passPicture(double picture_s);
  /// The next one, if it is time for it.
  std::optional<ScriptAction> takeDue();
  /// Whether that is a button which goes down.
  bool isAboutToPress() const;

  /// Whether it goes on while a model is loaded or saved.
  bool isImpatient() const { return impatient_; }
  void setImpatient(bool on) { impatient_ = on; }

  /// What the last one is to click has no place yet: it comes again. False after so many times in vain.
  bool lookAgain();
  /// What the last one waits for is not there yet: it comes again, and no time passes. False after a minute in vain.
  bool awaitAgain();
  /// It is there.
  void hasCome() { awaits_.reset(); }
  /// The button goes down and up again before anything else; the pictures in which it does are given to the panels.
  void pressAndRelease();

 private:
  bool standsStill() const { return awaits_ || looks_ > 0 || next_ < clickEnd_; }

  std::vector<TimedAction> actions_;
  bool ownClock_, impatient_ = false;
  std::size_t next_ = 0, clickEnd_ = 0;
  Stopwatch sinceStart_;
  double time_s_ = 0;
  int looks_ = 0;  // in vain
  std::optional<Stopwatch> awaits_;
};

}  // namespace palpate
