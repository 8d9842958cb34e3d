#pragma once

#include <algorithm>
#include <cstddef>

namespace palpate {

/// Times of edits that a back end keeps: a minute at 1 kHz without an allocation on the servo thread.
constexpr std::size_t kEditTimesKept = 1 << 16;

/// How often a session in real time may edit. While an edit runs, the force lives on the last answer; an edit that
/// takes longer than that answer is good for leaves the hand without force. After such an edit comes a rest, as long as
/// it took, twice the last rest where that is longer, and ten times as long as the edit at most; the first edit in time
/// ends it. So a hitch, as of a CPU that something else has had for a moment, costs as long again, and a GPU that is
/// too slow edits for a tenth of the time.
class EditPace {
 public:
  explicit EditPace(double longest_s) : longest_s_(longest_s) {}

  bool mayEdit(double time_s) const { return time_s >= restUntil_s_; }
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

}  // namespace palpate
