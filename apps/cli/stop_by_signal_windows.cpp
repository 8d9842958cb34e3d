#include <windows.h>

#include "apps/cli/stop_by_signal.hpp"

namespace palpate {

namespace {

std::atomic<bool> stopRequested = false;

// On a thread that the system starts for it. After Ctrl+C the program goes on when this returns; in all other cases it
// is ended then, so that it is given the time that it has (some seconds) to end by itself.
BOOL WINAPI askToStop(DWORD event) {
  stopRequested = true;
  if (event != CTRL_C_EVENT && event != CTRL_BREAK_EVENT) ::Sleep(INFINITE);
  return TRUE;
}

}  // namespace

StopBySignal::StopBySignal() { ::SetConsoleCtrlHandler(askToStop, TRUE); }

StopBySignal::~StopBySignal() { ::SetConsoleCtrlHandler(askToStop, FALSE); }

const std::atomic<bool>& StopBySignal::requested() { return stopRequested; }

int StopBySignal::exitCode() {
  constexpr int kInterrupted = 130;  // as on other systems
  return kInterrupted;
}

}  // namespace palpate
