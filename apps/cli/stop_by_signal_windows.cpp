#include <windows.h>

#include "apps/cli/stop_by_signal.hpp"

namespace palpate {

namespace {

std::atomic<bool> stopRequested = false;

// Called on a thread of the system. After Ctrl+C and Ctrl+Break the program continues when this returns; in other cases
// Windows ends it then, so this sleeps to give the program some seconds to end by itself.
BOOL WINAPI askToStop(DWORD event) {
  stopRequested = true;
  if (event != CTRL_C_EVENT && event != CTRL_BREAK_EVENT) ::Sleep(INFINITE);
  return TRUE;
}

}  // namespace

StopBySignal::StopBySignal() { ::SetConsoleCtrlHandler(askToStop, TRUE); }

StopBySignal::~StopBySignal() { ::SetConsoleCtrlHandler(askToStop, FALSE); }

void removeTemporaryFilesAtSignals() {}  // Windows removes no file that is open

const std::atomic<bool>& StopBySignal::requested() { return stopRequested; }

int StopBySignal::exitCode() {
  constexpr int kInterrupted = 130;  // as on other systems
  return kInterrupted;
}

}  // namespace palpate
