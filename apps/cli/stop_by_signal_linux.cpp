#include <csignal>

#include "apps/cli/stop_by_signal.hpp"

namespace palpate {

namespace {

std::atomic<bool> stopRequested = false;  // what a signal handler may touch
std::atomic<int> whichSignal = SIGINT;

// One that whoever started the program has it ignore, as nohup does, stays ignored.
void handle(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

StopBySignal::StopBySignal() {
  handle([](int signal) {
    whichSignal = signal;
    stopRequested = true;
  });
}

StopBySignal::~StopBySignal() { handle(SIG_DFL); }

const std::atomic<bool>& StopBySignal::requested() { return stopRequested; }

int StopBySignal::exitCode() {
  constexpr int kOfSignals = 128;  // POSIX shells, 2.8.2
  return kOfSignals + whichSignal;
}

}  // namespace palpate
