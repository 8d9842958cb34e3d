// Removes the force before a signal ends the program.
#pragma once

#include "engine/core/contact_query.hpp"
#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// While it lives, the signals by which a program crashes or is asked to end (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT,
/// SIGTERM, SIGINT, SIGHUP, SIGQUIT) call the device's emergencyStop(), and then the former handler or the default
/// action. An ignored signal stays ignored. A handler that the program installs meanwhile stays, and comes after this
/// one from the next CrashStop on. On Windows these are unhandled exceptions, abort(), Ctrl+C, Ctrl+Break, and a
/// console or a user's session that is closed; a program that is ended from the task manager is not notified.
class CrashStop {
 public:
  /// Throws Error if kMaxDevices are guarded already.
  explicit CrashStop(HapticDevice& device, const void* owner = nullptr);
  ~CrashStop();
  CrashStop(const CrashStop&) = delete;
  CrashStop& operator=(const CrashStop&) = delete;

  /// The program goes on after such a signal: resumes the guarded devices of this owner. For any thread.
  static void resume(const void* owner);

  static constexpr int kMaxDevices = static_cast<int>(kMaxHands);

 private:
  int slot_ = 0;
};

}  // namespace palpate
