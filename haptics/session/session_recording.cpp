#include "haptics/session/session_recording.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.hpp"
#include "haptics/session/recorded_contacts.hpp"
#include "haptics/session/session.hpp"

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

void Session::record(const std::string& file, const OpenHand& hand, RecordingFault onFault, const RunOptions& run) {
  require(Action::record, file);
  if (!pointHistory())
    throw Error("{}: a session without a history cannot be recorded; its end would not be known", file);
  SessionConfig config = config_;
  config.realtime = config.realtime || run.realtime;
  if (run.rate_Hz > 0) config.rate_Hz = run.rate_Hz;
  const CommandChannel::Loan loan(channel_);
  auto begun = std::make_unique<SessionRecording>(file,
                                                  RecordedSession{.config = config,
                                                                  .built = built_,
                                                                  .paintable = isPaintable_,
                                                                  .points = model().cloud.size(),
                                                                  .checksum = checksumOf(model()),
                                                                  .machine = machine_,
                                                                  .palpate = PALPATE_VERSION,
                                                                  .limits = hand.device->limits(),
                                                                  .map = hand.map,
                                                                  .passivity = hand.passivity},
                                                  backend_->edits(), std::move(onFault));
  SessionWriter& writer = begun->writer();
  EditBatch past = attributeHistory();
  channel_.begin(std::move(begun), channel_.isLent() ? recordContacts(*backend_) : std::vector<double>());
  relay_.setLog(&writer);
  logAttributes(writer, past);
}

// The log begins with the model's file: its masks and fields are made first.
void Session::logAttributes(SessionWriter& log, const EditBatch& past) {
  log.add(past);
  const auto undone = std::ranges::count(past.marks, EditMark::Kind::undone, &EditMark::kind);
  for (std::size_t i = past.marks.size() - static_cast<std::size_t>(undone); i > 0; --i)
    channel_.note(LoggedCommand::Kind::attribute, {});
  if (undone > 0) channel_.note(LoggedCommand::Kind::undo, std::to_string(undone));
}

std::unique_ptr<SessionRecording> Session::releaseRecording() {
  if (!recording()) return nullptr;
  const CommandChannel::Loan loan(channel_, true);
  relay_.setLog(nullptr);
  return channel_.release();
}

void Session::endRecording() {
  const std::unique_ptr<SessionRecording> ended = releaseRecording();
  if (ended) ended->finish(endChecksum());
}

}  // namespace palpate
