#pragma once

#include <algorithm>
#include <cstddef>

namespace palpate {

/// Number of edit times that a back end keeps: a minute at 1 kHz without an allocation on the servo thread.
constexpr std::size_t kEditTimesKept = 1 << 16;

/// Limits how often a session in real time may edit. While an edit runs, the force relies on the last answer; an edit
/// longer than that answer is valid leaves the hand without force. A rest follows such an edit: as long as the edit
/// took, or twice the last rest if longer, at most ten times the edit. The first edit in time ends it. So a short
/// hitch, as when the CPU was preempted, costs its own length again, and a GPU that is too slow edits for a tenth of
/// the time.
class EditPace {
 public:
  explicit EditPace(double longest_s) : longest_s_(longest_s) {}

  /// After an edit in time always, whatever the time: a hand that was finished has run ahead of the next query.
  bool mayEdit(double time_s) const { return rest_s_ == 0 || time_s >= restUntil_s_; }
  /// The edit that began at `time_s` took `duration_s`.
  void took(double time_s, double duration_s) {
    rest_s_ = duration_s > longest_s_ ? std::clamp(2 * rest_s_, duration_s, kMaxRests * duration_s) : 0;
    restUntil_s_ = time_s + rest_s_;
  }

 private:
  static constexpr double kMaxRests = 10;

  double longest_s_;
  double rest_s_ = 0, restUntil_s_ = 0;
};

/// Limits how often a session in virtual time may edit, by the work of its edits, so that its result does not depend on
/// the machine. An edit begins when those before it would be completed on two cores, or kAhead_s before: a stroke with
/// more work than that is edited as on a machine that completes a share of the ticks.
class WorkPace {
 public:
  bool mayEdit(double time_s) const { return completed_s_ <= time_s + kAhead_s; }
  /// The same at the end of a stroke, whose remaining path is then dropped.
  bool mayComplete(double time_s) const { return completed_s_ <= time_s + kCompletes_s; }
  /// The edit that began at `time_s` took `work`: CpuSculpture::work().
  void took(double time_s, double work) { completed_s_ = std::max(completed_s_, time_s) + work / kWorkPerSecond; }

 private:
  static constexpr double kAhead_s = 1, kCompletes_s = 3, kWorkPerSecond = 140e6;

  double completed_s_ = 0;
};

}  // namespace palpate
