// No force outlives the program: a signal that ends it takes the force away first.
#pragma once

#include "engine/core/contact_query.hpp"
#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// While it lives, the signals by which a program crashes or is asked to end (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT,
/// SIGTERM, SIGINT, SIGHUP, SIGQUIT) call the device's emergencyStop() first and then take the course they had before:
/// the handler that was there, or the default. A signal that was ignored stays so. Handlers put in place while it lives
/// are its caller's affair. On Windows these are exceptions that nobody handles, abort(), Ctrl+C, Ctrl+Break, and a
/// console or a user's session that is closed; a program that is ended from the task manager is not asked.
class CrashStop {
 public:
  /// Throws Error where kMaxDevices are guarded already.
  explicit CrashStop(HapticDevice& device);
  ~CrashStop();
  CrashStop(const CrashStop&) = delete;
  CrashStop& operator=(const CrashStop&) = delete;

  static constexpr int kMaxDevices = static_cast<int>(kMaxHands);

 private:
  int slot_ = 0;
};

}  // namespace palpate
