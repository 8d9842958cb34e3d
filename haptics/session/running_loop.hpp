// What the commands of a session reach of its servo loop.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "haptics/lendable_query.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session/hand_publisher.hpp"
#include "haptics/session/session_recording.hpp"

namespace palpate {

/// Notifies a recording and other recorders; any may be null.
class Recorders final : public TickRecorder {
 public:
  Recorders(SessionRecording* recording, const std::array<TickRecorder*, 2>& others)
      : recording_(recording), others_(others) {}
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override {
    if (recording_) recording_->ticked(row, device);
    for (TickRecorder* each : others_)
      if (each) each->ticked(row, device);
  }
  void tickedToo(std::size_t hand, const TraceRow& row) noexcept override {
    for (TickRecorder* each : others_)
      if (each) each->tickedToo(hand, row);
  }
  SessionRecording* recording() const noexcept { return recording_; }
  void setRecording(SessionRecording* recording) noexcept { recording_ = recording; }

 private:
  SessionRecording* recording_;
  std::array<TickRecorder*, 2> others_;
};

/// A servo loop in progress. All calls are for its thread, between two ticks.
class RunningLoop {
 public:
  RunningLoop(ServoLoop& loop, LendableQuery& query, Recorders& recorders, HandPublisher& publisher)
      : loop_(loop), query_(query), recorders_(recorders), publisher_(publisher) {}

  /// Result of lend().
  struct Lent {
    double next_s = 0;        ///< time of the next tick
    std::size_t numbers = 0;  ///< of the loop's state
    std::uint64_t tick = 0;   ///< of the recording
  };
  Lent lend(bool endsRecording) noexcept;

  /// Arguments of takeBack().
  struct Return {
    const ForceOptions& force;
    bool sculpts = false;                   ///< the first hand has a brush
    SessionRecording* recording = nullptr;  ///< from the next tick on
    std::span<double> state;                ///< receives the loop's state if that recording begins now
  };
  /// Returns the number of the recording's next tick.
  std::uint64_t takeBack(const Return& with) noexcept;
  /// As takeBack().
  std::uint64_t setForce(const ForceOptions& force) noexcept;
  std::uint64_t noteCommand() noexcept;

 private:
  ServoLoop& loop_;
  LendableQuery& query_;
  Recorders& recorders_;
  HandPublisher& publisher_;
};

}  // namespace palpate
