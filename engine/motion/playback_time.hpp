#pragma once

namespace palpate {

/// Maps session time to the position in a recording, which advances at a speed or is paused. Both in seconds.
class PlaybackTime {
 public:
  explicit PlaybackTime(double speed) : speed_(speed) {}

  double placeAt(double time_s) const { return isPaused_ ? begin_s_ : begin_s_ + speed_ * (time_s - since_s_); }
  /// Session time at which a position is due.
  double timeOf(double place_s) const { return since_s_ + (place_s - begin_s_) / speed_; }

  // Take effect at that session time.
  void pause(double time_s) {
    goTo(placeAt(time_s), time_s);
    isPaused_ = true;
  }
  void play(double time_s) {
    goTo(placeAt(time_s), time_s);
    isPaused_ = false;
  }
  void setSpeed(double speed, double time_s) {
    goTo(placeAt(time_s), time_s);
    speed_ = speed;
  }
  /// Only while paused.
  void stepTo(double place_s) { begin_s_ = place_s; }
  bool isPaused() const { return isPaused_; }
  double speed() const { return speed_; }

 private:
  void goTo(double place_s, double time_s) {
    begin_s_ = place_s;
    since_s_ = time_s;
  }

  double speed_;
  double since_s_ = 0, begin_s_ = 0;  // at session time since_s_ position begin_s_ is due
  bool isPaused_ = false;
};

}  // namespace palpate
