#include <csignal>

#include "apps/cli/stop_by_signal.hpp"

namespace palpate {

namespace {

std::atomic<bool> stopRequested = false;  // what a signal handler may touch

void handle(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, handler);
}

}  // namespace

StopBySignal::StopBySignal() {
  handle([](int) { stopRequested = true; });
}

StopBySignal::~StopBySignal() { handle(SIG_DFL); }

const std::atomic<bool>& StopBySignal::requested() { return stopRequested; }

}  // namespace palpate
