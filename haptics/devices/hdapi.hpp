// The part of OpenHaptics' HDAPI (3D Systems) that palpate calls, as a table of functions found at run time. Types are
// those of 64-bit systems (unsigned long as on each system); no vendor header is needed.
#pragma once

#include <cstdint>
#include <string>

#include "haptics/devices/vendor_library.hpp"

namespace palpate::hdapi {

using Handle = std::uint32_t;
using Enum = std::uint32_t;
using SchedulerHandle = unsigned long;
using Callback = std::uint32_t (*)(void*);

constexpr Handle kNoDevice = 0xFFFFFFFF;
constexpr std::uint32_t kCallbackDone = 0, kCallbackContinue = 1;
constexpr std::uint32_t kWaitCheck = 0, kWaitCompletion = 1;
constexpr std::uint16_t kDefaultPriority = 32767;

/// Parameters to query, set and switch.
enum Parameter : Enum {
  kCurrentButtons = 0x2000,
  kCurrentPosition = 0x2050,   ///< 3 doubles, mm
  kCurrentTransform = 0x2052,  ///< 16 doubles, column by column, mm
  kVersion = 0x2500,
  kModelType = 0x2501,
  kDriverVersion = 0x2502,
  kVendor = 0x2503,
  kSerialNumber = 0x2504,
  kUsableWorkspace = 0x2551,     ///< 6 doubles, minimum and maximum x, y, z, mm
  kMaxForce = 0x2603,            ///< N
  kMaxContinuousForce = 0x2604,  ///< N
  kMotorTemperature = 0x2605,    ///< of each motor, 0 cold to 1 hot
  kCurrentForce = 0x2700,        ///< 3 doubles, N
  kForceOutput = 0x4000,
  kMaxForceClamping = 0x4001,
};
enum Calibration : Enum { kCalibrated = 0x5000, kNeedsUpdate = 0x5001, kNeedsManualInput = 0x5002 };
enum CalibrationStyle : Enum { kByEncoder = 1, kAutomatic = 2, kByInkwell = 4 };

/// Entry of the library's error stack, newest first; code 0: no error.
struct ErrorInfo {
  std::uint32_t code = 0;
  std::int32_t internalCode = 0;
  Handle device = kNoDevice;
};
static_assert(sizeof(ErrorInfo) == 12);

/// What an error means for the force.
enum class Severity {
  none,
  rampBack,  ///< no force at this tick; it ramps up again
  pause,     ///< no force until the cause has gone
  end        ///< the session is over
};

struct ErrorMeaning {
  std::uint32_t code;
  Severity severity;
  const char* words;  ///< what happened
  const char* advice;
};
/// Meaning of every code of the interface; any other code is reported as unknown, which ends the session.
const ErrorMeaning& meaningOf(std::uint32_t code);

/// The functions. All of them are set, unless stated otherwise.
struct Api {
  /// Throws Error when the library lacks any that is needed.
  explicit Api(const VendorLibrary& library);
  /// Names of missing functions, for a survey without a session.
  static std::vector<std::string> missingFrom(const VendorLibrary& library);

  Handle (*initDevice)(const char* name) = nullptr;
  void (*disableDevice)(Handle) = nullptr;
  void (*makeCurrentDevice)(Handle) = nullptr;
  void (*beginFrame)(Handle) = nullptr;
  void (*endFrame)(Handle) = nullptr;
  ErrorInfo (*getError)() = nullptr;
  const char* (*getErrorString)(std::uint32_t code) = nullptr;
  void (*enable)(Enum) = nullptr;
  void (*disable)(Enum) = nullptr;
  void (*getIntegerv)(Enum, std::int32_t*) = nullptr;
  void (*getDoublev)(Enum, double*) = nullptr;
  void (*setDoublev)(Enum, const double*) = nullptr;
  const char* (*getString)(Enum) = nullptr;
  Enum (*checkCalibration)() = nullptr;
  void (*updateCalibration)(Enum style) = nullptr;
  void (*startScheduler)() = nullptr;
  void (*stopScheduler)() = nullptr;
  SchedulerHandle (*scheduleAsynchronous)(Callback, void*, std::uint16_t priority) = nullptr;
  void (*unschedule)(SchedulerHandle) = nullptr;
  std::uint8_t (*waitForCompletion)(SchedulerHandle, std::uint32_t code) = nullptr;
  // Missing in older libraries.
  void (*setSchedulerRate)(unsigned long rate_Hz) = nullptr;
  Enum (*checkCalibrationStyle)() = nullptr;

 private:
  Api() = default;
  SymbolTable fill(const VendorLibrary& library);
};

/// How the library is found.
const LibrarySearch& librarySearch();

}  // namespace palpate::hdapi
