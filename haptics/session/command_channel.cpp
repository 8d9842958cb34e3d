#include "haptics/session/command_channel.hpp"

#include <utility>

#include "engine/core/log.hpp"
#include "haptics/session/recorded_contacts.hpp"

namespace palpate {

void CommandChannel::borrow(bool endsRecording) {
  if (loans_ > 0) {
    ++loans_;
    return;
  }
  notes_.clear();
  const bool had = isLent_;  // by lend()
  isLent_ = post([this, endsRecording](RunningLoop& loop) noexcept {
              lent_ = loop.lend(endsRecording);
              return lent_.tick;
            }).has_value();
  ++loans_;
  try {
    if (isLent_ && !had && !endsRecording) add(lent_.tick, {.kind = LoggedCommand::Kind::lend});
    parts_.settle();
  } catch (...) {
    giveBack();
    throw;
  }
}

// If the loop does not take it back in time, the planes fade, and the next command takes it back.
void CommandChannel::giveBack() noexcept {
  if (--loans_ > 0 || !isLent_) return;
  try {
    const RunningLoop::Return with{.force = parts_.config.force,
                                   .sculpts = parts_.config.brush.has_value(),
                                   .recording = recording_.get(),
                                   .state = state_};
    isLent_ = false;
    if (const auto tick = post([&with](RunningLoop& loop) noexcept { return loop.takeBack(with); })) record(*tick);
  } catch (const std::exception& error) {
    if (parts_.log) parts_.log->warn("{}", error.what());
  }
}

void CommandChannel::record(std::uint64_t tick) {
  if (!contacts_.empty()) {
    state_.insert(state_.end(), contacts_.begin(), contacts_.end());
    contacts_.clear();
    add(tick, {.kind = LoggedCommand::Kind::begin, .content = contentOf(state_)});
  } else if (notes_.empty()) {
    add(tick, {.kind = LoggedCommand::Kind::back});
  }
  for (LoggedCommand& each : notes_) add(tick, std::move(each));
}

void CommandChannel::lend() {
  isLent_ = post([this](RunningLoop& loop) noexcept {
              lent_ = loop.lend(false);
              return lent_.tick;
            }).has_value();
}

void CommandChannel::begin(std::unique_ptr<SessionRecording> recording, std::vector<double> contacts) {
  if (isLent_) {
    state_.assign(lent_.numbers, 0);
    recording->beginAt(next_s());
  }
  contacts_ = std::move(contacts);
  recording_ = std::move(recording);
}

std::unique_ptr<SessionRecording> CommandChannel::release() {
  contacts_.clear();
  return std::exchange(recording_, nullptr);
}

void CommandChannel::add(std::uint64_t tick, LoggedCommand command) {
  if (!recording_) return;
  command.tick = tick;
  recording_->add(std::move(command));
}

void CommandChannel::note(LoggedCommand::Kind kind, std::string content) {
  if (!recording_) return;
  LoggedCommand command{.kind = kind, .content = std::move(content)};
  if (isLent_) return notes_.push_back(std::move(command));
  const std::uint64_t ticks = recording_->ticks();
  if (ticks == 0 || kind >= LoggedCommand::Kind::attribute) add(ticks, std::move(command));
}

}  // namespace palpate
