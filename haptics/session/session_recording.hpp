#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "haptics/session/session_header.hpp"
#include "haptics/session_writer.hpp"

namespace palpate {

/// Hears, once and in words, what could not be written.
using RecordingFault = std::function<void(const std::string&)>;

/// A session log under way.
class SessionRecording final : public TickRecorder {
 public:
  /// `onFault` hears of a fault on the log's thread; where it is empty, takeFault() keeps it. Throws FileError when the
  /// file cannot be made. `backend` outlives this.
  SessionRecording(const std::string& file, const RecordedSession& session, const TouchBackend& backend,
                   RecordingFault onFault = {});

  /// Of the first tick, whose time in the log is 0; ticks then count from there. Before it.
  void beginAt(double time_s) { begin_s_ = time_s; }
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override { tap_.ticked(row, device); }

  SessionWriter& writer() { return writer_; }
  /// What could not be written, in words, once. For any thread.
  std::optional<std::string> takeFault();
  /// Writes how the session ended. Throws FileError where not all could be written.
  void finish(std::uint64_t pointsChecksum) { writer_.finish(pointsChecksum); }

 private:
  void add(const LoggedTick& tick);

  double rate_Hz_;
  std::optional<double> begin_s_;
  std::mutex lock_;  // of
  std::optional<std::string> fault_;
  SessionWriter writer_;
  TickTap tap_;
};

}  // namespace palpate
