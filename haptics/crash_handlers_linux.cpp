#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>

#include "haptics/crash_handlers.hpp"

namespace palpate {
namespace {

constexpr std::array kSignals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGINT, SIGHUP, SIGQUIT};

using Action = struct sigaction;

/// What a signal did before. A program may put a handler of its own over ours and call ours from it: then ours stays
/// reachable below, and is put over that handler the next time.
struct Before {
  Action former{};         // continues after ours; written before a handler is in place
  Action beneath{};        // the one before that, if the former calls ours: ours then continues with this
  bool isCovered = false;  // a later handler may call ours
  std::atomic<pid_t> handledBy = 0;
};
std::array<Before, kSignals.size()> befores;

void stopThenGoOn(int signal, siginfo_t* info, void* context);

bool isOurs(const Action& action) { return (action.sa_flags & SA_SIGINFO) && action.sa_sigaction == stopThenGoOn; }
bool isIgnored(const Action& action) { return !(action.sa_flags & SA_SIGINFO) && action.sa_handler == SIG_IGN; }
bool isDefault(const Action& action) { return !(action.sa_flags & SA_SIGINFO) && action.sa_handler == SIG_DFL; }

/// Raised by a faulting instruction, not sent by a process.
bool isFault(int signal, const siginfo_t* info) {
  const bool mayBe = signal == SIGSEGV || signal == SIGBUS || signal == SIGFPE || signal == SIGILL;
  return mayBe && info->si_code > 0;
}

void goOn(const Action& with, int signal, siginfo_t* info, void* context) {
  if (isIgnored(with)) return;
  if (with.sa_flags & SA_SIGINFO) return with.sa_sigaction(signal, info, context);
  if (!isDefault(with)) return with.sa_handler(signal);
  ::sigaction(signal, &with, nullptr);
  // A fault recurs on return, with its own address for the debugger; any other signal is sent again.
  if (!isFault(signal, info)) ::raise(signal);
}

void stopThenGoOn(int signal, siginfo_t* info, void* context) {
  const int error = errno;
  stopGuardedDevices();
  errno = error;
  Before& before = befores[static_cast<std::size_t>(std::ranges::find(kSignals, signal) - kSignals.begin())];
  const pid_t self = ::gettid();
  if (before.handledBy == self) return goOn(before.beneath, signal, info, context);
  before.handledBy = self;
  goOn(before.former, signal, info, context);
  before.handledBy = 0;
}

}  // namespace

void putCrashHandlersInPlace() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    Before& before = befores[i];
    Action now{};
    ::sigaction(kSignals[i], nullptr, &now);
    if (isIgnored(now) || isOurs(now)) continue;
    before.beneath = before.isCovered ? before.former : Action{};
    before.former = now;
    Action ours{};
    ours.sa_sigaction = stopThenGoOn;
    // As the former one is run: a call that it interrupts stays interrupted.
    ours.sa_flags = SA_SIGINFO | SA_ONSTACK | (isDefault(now) ? SA_RESTART : now.sa_flags & (SA_RESTART | SA_NODEFER));
    ours.sa_mask = now.sa_mask;
    ::sigaction(kSignals[i], &ours, nullptr);
    before.isCovered = true;
  }
}

void putCrashHandlersBack() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    Action now{};
    ::sigaction(kSignals[i], nullptr, &now);
    if (!isOurs(now)) continue;
    ::sigaction(kSignals[i], &befores[i].former, nullptr);
    befores[i].isCovered = false;
  }
}

}  // namespace palpate
