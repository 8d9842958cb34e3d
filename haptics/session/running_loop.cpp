#include "haptics/session/running_loop.hpp"

#include <algorithm>

namespace palpate {

RunningLoop::Lent RunningLoop::lend(bool endsRecording) noexcept {
  StateNumbers count;
  query_.visitState(count);
  const Lent lent{.next_s = loop_.next_s(), .numbers = loop_.stateSize() + count.count(), .tick = noteCommand()};
  query_.lend();
  if (SessionRecording* const recording = recorders_.recording()) recording->hold(true);
  if (endsRecording) recorders_.setRecording(nullptr);
  return lent;
}

std::uint64_t RunningLoop::takeBack(const Return& with) noexcept {
  query_.takeBack();
  loop_.setForce(with.force);
  publisher_.setSculpts(with.sculpts);
  if (with.recording != recorders_.recording()) {
    recorders_.setRecording(with.recording);
    const std::size_t own = std::min(loop_.stateSize(), with.state.size());
    loop_.saveState(with.state.first(own));
    StateNumbers numbers = StateNumbers::to(with.state.subspan(own));
    query_.visitState(numbers);
  }
  if (with.recording) with.recording->hold(false);
  return noteCommand();
}

std::uint64_t RunningLoop::setForce(const ForceOptions& force) noexcept {
  loop_.setForce(force);
  return noteCommand();
}

std::uint64_t RunningLoop::noteCommand() noexcept {
  SessionRecording* const recording = recorders_.recording();
  return recording ? recording->noteCommand() : 0;
}

}  // namespace palpate
