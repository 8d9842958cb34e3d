// How each system says that a program is about to end.
#pragma once

namespace palpate {

/// Called by the handlers, in a signal's as in a thread's context: stops every guarded device. It allocates nothing and
/// waits for no one.
void stopGuardedDevices() noexcept;

/// Handlers that call stopGuardedDevices() and then take the course that was there before, and that course alone again;
/// by turns, by one thread at a time.
void putCrashHandlersInPlace();
void putCrashHandlersBack();

}  // namespace palpate
