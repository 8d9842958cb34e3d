// The part of the Force Dimension SDK (libdhd) that we call, as a table of functions that are found at run time.
#pragma once

#include <string>

#include "haptics/devices/vendor_library.hpp"

namespace palpate::dhd {

struct Api {
  /// Throws Error when the library lacks any function that is needed.
  explicit Api(const VendorLibrary& library);
  /// The names that are missing, for a look without a session.
  static std::vector<std::string> missingFrom(const VendorLibrary& library);

  int (*openID)(char index) = nullptr;  ///< the device's id, or -1
  int (*close)(char id) = nullptr;
  int (*getPosition)(double* x_m, double* y_m, double* z_m, char id) = nullptr;  ///< -1 at an error
  int (*setForce)(double x_N, double y_N, double z_N, char id) = nullptr;
  unsigned (*getButtonMask)(char id) = nullptr;
  int (*enableForce)(unsigned char on, char id) = nullptr;
  int (*setWatchdog)(unsigned char ms, char id) = nullptr;  ///< forces go when none was set for so long
  // Some libraries have not these.
  const char* (*getSystemName)(char id) = nullptr;
  const char* (*lastError)() = nullptr;
  int (*getDeviceCount)() = nullptr;
  void (*getVersion)(int* major, int* minor, int* release, int* revision) = nullptr;

 private:
  Api() = default;
  SymbolTable fill(const VendorLibrary& library);
};

/// Where libdhd is looked for.
const LibrarySearch& librarySearch();

}  // namespace palpate::dhd
