// Removes the force before a signal ends the program.
#pragma once

#include "engine/core/contact_query.hpp"
#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// While it lives, the signals by which a program crashes or is asked to end (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT,
/// SIGTERM, SIGINT, SIGHUP, SIGQUIT) call the device's emergencyStop(), and then the former handler or the default
/// action. An ignored signal stays ignored. Handlers that others install meanwhile are their own responsibility. On
/// Windows these are unhandled exceptions, abort(), Ctrl+C, Ctrl+Break, and a console or a user's session that is
/// closed; a program that is ended from the task manager is not notified.
class CrashStop {
 public:
  /// Throws Error if kMaxDevices are guarded already.
  explicit CrashStop(HapticDevice& device);
  ~CrashStop();
  CrashStop(const CrashStop&) = delete;
  CrashStop& operator=(const CrashStop&) = delete;

  static constexpr int kMaxDevices = static_cast<int>(kMaxHands);

 private:
  int slot_ = 0;
};

}  // namespace palpate
