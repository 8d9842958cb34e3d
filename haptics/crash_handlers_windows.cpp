#include <windows.h>

#include <atomic>
#include <csignal>

#include "haptics/crash_handlers.hpp"

namespace palpate {
namespace {

// Written before a handler is in place.
LPTOP_LEVEL_EXCEPTION_FILTER formerFilter = nullptr;
void (*formerAbort)(int) = SIG_DFL;
// The thread whose fault is being passed on: a filter that was put over ours, and is under it now, may call it.
std::atomic<DWORD> handledBy = 0;

LONG WINAPI stopAtFault(EXCEPTION_POINTERS* fault) {
  stopGuardedDevices();
  const DWORD self = ::GetCurrentThreadId();
  if (!formerFilter || handledBy == self) return EXCEPTION_CONTINUE_SEARCH;
  handledBy = self;
  const LONG decision = formerFilter(fault);
  handledBy = 0;
  return decision;
}

void stopAtAbort(int signal) {
  stopGuardedDevices();
  const auto former = formerAbort;
  std::signal(SIGABRT, former);
  if (former != SIG_DFL && former != SIG_IGN && former != SIG_ERR) former(signal);
}

// Ctrl+C, Ctrl+Break, a console that is closed, a user who logs off: on a thread that the system starts for it. FALSE
// passes the event to the handler installed before.
BOOL WINAPI stopAtEnd(DWORD) {
  stopGuardedDevices();
  return FALSE;
}

}  // namespace

void putCrashHandlersInPlace() {
  if (const auto filter = ::SetUnhandledExceptionFilter(stopAtFault); filter != stopAtFault) formerFilter = filter;
  if (const auto abort = std::signal(SIGABRT, stopAtAbort); abort != stopAtAbort) formerAbort = abort;
  ::SetConsoleCtrlHandler(stopAtEnd, FALSE);  // the last one installed is called first
  ::SetConsoleCtrlHandler(stopAtEnd, TRUE);
}

void putCrashHandlersBack() {
  ::SetConsoleCtrlHandler(stopAtEnd, FALSE);
  // A handler that the program has put over ours stays.
  if (const auto abort = std::signal(SIGABRT, formerAbort); abort != stopAtAbort) std::signal(SIGABRT, abort);
  if (const auto filter = ::SetUnhandledExceptionFilter(formerFilter); filter != stopAtFault)
    ::SetUnhandledExceptionFilter(filter);
}

}  // namespace palpate
