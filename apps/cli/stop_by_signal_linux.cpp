#include <csignal>

#include "apps/cli/stop_by_signal.hpp"

namespace palpate {

namespace {

std::atomic<bool> stopRequested = false;  // what a signal handler may touch

// One that whoever started the program has it ignore, as nohup does, stays ignored.
void handle(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

StopBySignal::StopBySignal() {
  handle([](int) { stopRequested = true; });
}

StopBySignal::~StopBySignal() { handle(SIG_DFL); }

const std::atomic<bool>& StopBySignal::requested() { return stopRequested; }

}  // namespace palpate
