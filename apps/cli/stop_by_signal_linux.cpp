#include <csignal>

#include "apps/cli/stop_by_signal.hpp"
#include "engine/core/atomic_file.hpp"

namespace palpate {

namespace {

std::atomic<bool> stopRequested = false;  // safe in a signal handler
std::atomic<int> whichSignal = SIGINT;

// SIGHUP stays ignored if it was, as under nohup. SIGINT does not: shells let background commands of a script ignore it
// (POSIX, 2.11), but a script that sends it to a server expects an effect.
void handle(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, handler);
  if (std::signal(SIGHUP, handler) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

}  // namespace

StopBySignal::StopBySignal() {
  handle([](int signal) {
    whichSignal = signal;
    stopRequested = true;
  });
}

StopBySignal::~StopBySignal() { removeTemporaryFilesAtSignals(); }

void removeTemporaryFilesAtSignals() {
  const auto end = [](int signal) {
    removeTemporaryFiles();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  };
  handle(end);
  for (const int signal : {SIGPIPE, SIGQUIT, SIGXCPU})
    if (std::signal(signal, end) == SIG_IGN) std::signal(signal, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit of sizes is an error of its write
}

const std::atomic<bool>& StopBySignal::requested() { return stopRequested; }

int StopBySignal::exitCode() {
  constexpr int kOfSignals = 128;  // POSIX shells, 2.8.2
  return kOfSignals + whichSignal;
}

}  // namespace palpate
