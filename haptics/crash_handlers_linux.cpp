#include "haptics/crash_handlers.hpp"

#include <array>
#include <csignal>

namespace palpate {
namespace {

constexpr std::array kSignals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGINT, SIGHUP, SIGQUIT};

std::array<struct sigaction, kSignals.size()> former;  // written before a handler is in place

/// Raised by a faulting instruction, not sent by a process.
bool isFault(int signal, const siginfo_t* info) {
  const bool mayBe = signal == SIGSEGV || signal == SIGBUS || signal == SIGFPE || signal == SIGILL;
  return mayBe && info->si_code > 0;
}

void stopThenGoOn(int signal, siginfo_t* info, void* context) {
  stopGuardedDevices();
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    if (kSignals[i] != signal) continue;
    const struct sigaction& before = former[i];
    if (before.sa_flags & SA_SIGINFO) return before.sa_sigaction(signal, info, context);
    if (before.sa_handler != SIG_DFL) return before.sa_handler(signal);
    ::sigaction(signal, &before, nullptr);
    // A fault recurs on return, with its own address for the debugger; any other signal is sent again.
    if (!isFault(signal, info)) ::raise(signal);
    return;
  }
}

}  // namespace

void putCrashHandlersInPlace() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals[i], nullptr, &former[i]);
    if (!(former[i].sa_flags & SA_SIGINFO) && former[i].sa_handler == SIG_IGN) continue;
    struct sigaction ours {};
    ours.sa_sigaction = stopThenGoOn;
    ours.sa_flags = SA_SIGINFO | SA_RESTART | SA_ONSTACK;
    ::sigemptyset(&ours.sa_mask);
    ::sigaction(kSignals[i], &ours, nullptr);
  }
}

void putCrashHandlersBack() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &former[i], nullptr);
}

}  // namespace palpate
