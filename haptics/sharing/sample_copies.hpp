// Copies of strokes or results on a best-effort topic of their own.
#pragma once

#include <span>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/sharing/copy_schedule.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// For each who hears them. Three copies of what a hand does come to half of that.
inline constexpr double kCopies_B_per_s = 500e3;

/// Sample: Stroke or Result, whose numbers say which copy comes first, and that a later one is none.
template <class Sample>
class SampleCopies {
 public:
  SampleCopies() = default;
  SampleCopies(dds_entity_t participant, const Topic<Sample>& topic, const Qos& qos) : writer_(participant, topic, qos) {}

  void setRate(double bytes_per_s) { schedule_.setRate(bytes_per_s); }
  /// It was written the reliable way just now.
  void wrote(const Sample& sample) {
    constexpr std::size_t kHeaders = 160;  // of the sample, and of what it is wrapped in
    const std::span<const State> states(sample.states._buffer, sample.states._length);
    schedule_.add({sample, {states.begin(), states.end()}}, kHeaders + states.size_bytes(), since_.elapsed_s());
  }
  void forget() { schedule_.clear(); }
  /// Writes those that are due; so many seconds later there are more.
  double write() {
    schedule_.sayDue(since_.elapsed_s(), [&](Kept& kept) {
      kept.sample.states._buffer = kept.states.data();
      writer_.write(kept.sample);
    });
    return schedule_.next_s(since_.elapsed_s());
  }

 private:
  struct Kept {
    Sample sample;  // but for its states
    std::vector<State> states;
  };
  Writer<Sample> writer_;
  CopySchedule<Kept> schedule_{kCopies_B_per_s};
  Stopwatch since_;
};

}  // namespace palpate::sharing
