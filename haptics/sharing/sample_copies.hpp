// Copies of strokes or results on a best-effort topic of their own.
#pragma once

#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/sharing/copy_schedule.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// Per receiver. Four copies of one hand's strokes need about that.
inline constexpr double kCopies_B_per_s = 500e3;

/// A Stroke or a Result that is kept beyond DDS's loan.
template <class Sample>
struct KeptSample {
  explicit KeptSample(const Sample& given)
      : states(given.states._buffer, given.states._buffer + given.states._length), sample_(given) {}
  const Sample& sample() {
    sample_.states._buffer = states.data();
    return sample_;
  }
  std::vector<State> states;

 private:
  Sample sample_;  // without its states
};

/// Sample: Stroke or Result; their numbers tell which copy is the first one received, and that later ones are
/// duplicates.
template <class Sample>
class SampleCopies {
 public:
  SampleCopies() = default;
  SampleCopies(dds_entity_t participant, const Topic<Sample>& topic, const Qos& qos)
      : writer_(participant, topic, qos) {}

  void setRate(double bytes_per_s) { schedule_.setRate(bytes_per_s); }
  /// The sample was just written on the reliable path.
  void wrote(const Sample& sample) {
    constexpr std::size_t kHeaders = 160;  // of the sample, and of its packet
    schedule_.add(KeptSample<Sample>(sample), kHeaders + sample.states._length * sizeof(State), since_.elapsed_s());
  }
  void forget() { schedule_.clear(); }
  /// Writes those that are due; returns the seconds until the next ones.
  double write() {
    schedule_.sayDue(since_.elapsed_s(), [&](KeptSample<Sample>& kept) { writer_.write(kept.sample()); });
    return schedule_.next_s(since_.elapsed_s());
  }

 private:
  Writer<Sample> writer_;
  CopySchedule<KeptSample<Sample>> schedule_{kCopies_B_per_s};
  Stopwatch since_;
};

}  // namespace palpate::sharing
