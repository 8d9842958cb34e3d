#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "haptics/session/session_header.hpp"
#include "haptics/session_writer.hpp"

namespace palpate {

/// Called once, with what could not be written.
using RecordingFault = std::function<void(const std::string&)>;

/// A session log in progress.
class SessionRecording final : public TickRecorder {
 public:
  /// `onFault` is called on the log's thread; if it is empty, takeFault() returns the fault. Throws FileError if the
  /// file cannot be created. `edits` (TickTap) must outlive this object.
  SessionRecording(const std::string& file, const RecordedSession& session, const EditStream* edits,
                   RecordingFault onFault = {});

  /// Sets the time of the first tick, which is 0 in the log; later ticks are counted from there. Before the first tick.
  void beginAt(double time_s) { begin_s_ = time_s; }
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override { tap_.ticked(row, device); }

  // On the servo thread, between two ticks.
  /// TickTap::hold().
  void hold(bool on) noexcept { tap_.hold(on); }
  /// A command takes effect before the next tick, whose number is returned.
  std::uint64_t noteCommand() noexcept {
    tap_.noteCommand();
    return ticks_;
  }

  /// Records a command that has taken effect. For the session's thread.
  void add(LoggedCommand command) { writer_.add(std::move(command)); }

  SessionWriter& writer() { return writer_; }
  /// Number of recorded ticks. For the thread that ticks, or while none are made.
  std::uint64_t ticks() const { return ticks_; }
  /// Returns once what could not be written. Thread-safe.
  std::optional<std::string> takeFault();
  /// Records how the session ended. Throws FileError if not everything could be written, unless takeFault() has said
  /// so.
  void finish(std::uint64_t pointsChecksum);

 private:
  void add(const LoggedTick& tick);

  double rate_Hz_;
  std::optional<double> begin_s_;
  std::uint64_t ticks_ = 0;
  std::mutex lock_;  // protects fault_
  std::optional<std::string> fault_;
  bool isFaultTaken_ = false;
  SessionWriter writer_;
  TickTap tap_;
};

}  // namespace palpate
