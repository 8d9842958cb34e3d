// How each system notifies a program that it is about to end.
#pragma once

namespace palpate {

/// Called by the handlers, in the context of a signal or a thread: stops every guarded device. Neither allocates nor
/// waits.
void stopGuardedDevices() noexcept;

/// Installs handlers that call stopGuardedDevices() and then continue as the former ones would, also over handlers that
/// the program has installed since the last call; restores the former ones, except where the program has installed
/// others since. Called by one thread at a time.
void putCrashHandlersInPlace();
void putCrashHandlersBack();

}  // namespace palpate
