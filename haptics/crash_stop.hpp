// No force outlives the program: a signal that ends it takes the force away first.
#pragma once

#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// While it lives, the signals by which a program crashes or is told to go (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT,
/// SIGTERM, SIGINT, SIGHUP, SIGQUIT) call the device's emergencyStop() first and then take the course they had before:
/// the handler that was there, or the default. A signal that was ignored stays so. Handlers put in place while it lives
/// are its caller's affair.
class CrashStop {
 public:
  /// Up to kMostDevices may be guarded at a time; more stop the program (a bug).
  explicit CrashStop(HapticDevice& device);
  ~CrashStop();
  CrashStop(const CrashStop&) = delete;
  CrashStop& operator=(const CrashStop&) = delete;

  static constexpr int kMostDevices = 4;

 private:
  int slot_ = 0;
};

}  // namespace palpate
