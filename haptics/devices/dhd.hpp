// The part of the Force Dimension SDK (libdhd) that palpate calls, as a table of functions found at run time.
#pragma once

#include <string>

#include "haptics/devices/vendor_library.hpp"

namespace palpate::dhd {

struct Api {
  /// Throws Error when the library lacks any function that is needed.
  explicit Api(const VendorLibrary& library);
  /// Names of missing functions, for a survey without a session.
  static std::vector<std::string> missingFrom(const VendorLibrary& library);

  int (*openID)(char index) = nullptr;  ///< the device's id, or -1
  int (*close)(char id) = nullptr;
  int (*getPosition)(double* x_m, double* y_m, double* z_m, char id) = nullptr;  ///< -1 on an error
  int (*setForce)(double x_N, double y_N, double z_N, char id) = nullptr;
  unsigned (*getButtonMask)(char id) = nullptr;
  int (*enableForce)(unsigned char on, char id) = nullptr;
  int (*setWatchdog)(unsigned char ms, char id) = nullptr;  ///< forces end if none was set for this long
  // Missing in some libraries.
  const char* (*getSystemName)(char id) = nullptr;
  int (*getSerialNumber)(unsigned short* number, char id) = nullptr;  ///< -1 on an error
  const char* (*lastError)() = nullptr;
  int (*getDeviceCount)() = nullptr;
  void (*getVersion)(int* major, int* minor, int* release, int* revision) = nullptr;

 private:
  Api() = default;
  SymbolTable fill(const VendorLibrary& library);
};

/// How libdhd is found.
const LibrarySearch& librarySearch();

}  // namespace palpate::dhd
