#include <windows.h>

#include <csignal>

#include "haptics/crash_handlers.hpp"

namespace palpate {
namespace {

LPTOP_LEVEL_EXCEPTION_FILTER formerFilter = nullptr;  // written before a handler is in place
void (*formerAbort)(int) = SIG_DFL;

LONG WINAPI stopAtFault(EXCEPTION_POINTERS* fault) {
  stopGuardedDevices();
  return formerFilter ? formerFilter(fault) : EXCEPTION_CONTINUE_SEARCH;
}

void stopAtAbort(int signal) {
  stopGuardedDevices();
  std::signal(SIGABRT, formerAbort);
  if (formerAbort != SIG_DFL && formerAbort != SIG_IGN) formerAbort(signal);
}

// Ctrl+C, Ctrl+Break, a console that is closed, a user who logs off: on a thread that the system starts for it. FALSE
// passes the event to the handler installed before.
BOOL WINAPI stopAtEnd(DWORD) {
  stopGuardedDevices();
  return FALSE;
}

}  // namespace

void putCrashHandlersInPlace() {
  formerFilter = ::SetUnhandledExceptionFilter(stopAtFault);
  formerAbort = std::signal(SIGABRT, stopAtAbort);
  ::SetConsoleCtrlHandler(stopAtEnd, TRUE);
}

void putCrashHandlersBack() {
  ::SetConsoleCtrlHandler(stopAtEnd, FALSE);
  std::signal(SIGABRT, formerAbort);
  ::SetUnhandledExceptionFilter(formerFilter);
}

}  // namespace palpate
