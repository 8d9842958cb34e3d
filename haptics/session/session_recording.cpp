#include "haptics/session/session_recording.hpp"

#include <cmath>
#include <utility>

namespace palpate {

SessionRecording::SessionRecording(const std::string& file, const RecordedSession& session, const EditStream* edits,
                                   RecordingFault onFault)
    : rate_Hz_(session.config.rate_Hz),
      writer_(file, headerText(session),
              [this, onFault = std::move(onFault)](const std::string& what) {
                if (onFault) return onFault(what);
                const std::scoped_lock hold(lock_);
                fault_ = what;
              }),
      tap_(edits, [this](const LoggedTick& tick) { add(tick); }) {}

void SessionRecording::add(const LoggedTick& tick) {
  ++ticks_;
  if (!begin_s_) return writer_.add(tick);
  LoggedTick counted = tick;
  counted.time_s = std::round((tick.time_s - *begin_s_) * rate_Hz_) / rate_Hz_;
  writer_.add(counted);
}

std::optional<std::string> SessionRecording::takeFault() {
  const std::scoped_lock hold(lock_);
  isFaultTaken_ = isFaultTaken_ || fault_;
  return std::exchange(fault_, std::nullopt);
}

void SessionRecording::finish(std::uint64_t pointsChecksum) {
  try {
    writer_.finish(pointsChecksum);
  } catch (const FileError&) {
    const std::scoped_lock hold(lock_);
    if (!isFaultTaken_) throw;
  }
}

}  // namespace palpate
