#include "haptics/devices/hdapi.hpp"

#include <algorithm>
#include <array>

#include "haptics/devices/system_devices.hpp"

namespace palpate::hdapi {
namespace {

constexpr std::string_view kProduct = "the OpenHaptics library (libHD)";

constexpr const char* kReport = "this is a fault of the program or of the driver; note what you did and report it";
constexpr const char* kReplug = "check cable and power of the device, and start again";

constexpr std::array kMeanings{
    ErrorMeaning{0x0000, Severity::none, "no error", ""},
    ErrorMeaning{0x0100, Severity::end, "a parameter that the driver does not know", "update the vendor's driver"},
    ErrorMeaning{0x0101, Severity::end, "a value that the driver does not accept", kReport},
    ErrorMeaning{0x0102, Severity::end, "a call that is not allowed now", kReport},
    ErrorMeaning{0x0103, Severity::end, "a value of the wrong type", kReport},
    ErrorMeaning{0x0104, Severity::end, "the device is no longer open", kReplug},
    ErrorMeaning{0x0200, Severity::pause, "the motors are warm", "let go and wait until they have cooled down"},
    ErrorMeaning{0x0201, Severity::rampBack, "more force than the device can give", "lower the maximum force"},
    ErrorMeaning{0x0202, Severity::rampBack, "the force rose faster than the device allows", "lower the stiffness"},
    ErrorMeaning{0x0203, Severity::rampBack, "the stylus moved faster than the device allows", "move more slowly"},
    ErrorMeaning{0x0204, Severity::rampBack, "the force could not be given", "hold the stylus still for a moment"},
    ErrorMeaning{0x0300, Severity::end, "the device reports a fault of its own", kReplug},
    ErrorMeaning{0x0301, Severity::end, "another program uses the device", "close that program, and start again"},
    ErrorMeaning{0x0302, Severity::end, "no communication with the device", kReplug},
    ErrorMeaning{0x0303, Severity::end, "the device's port is not set up",
                 "run the vendor's setup program (Touch_Setup) and pair the device"},
    ErrorMeaning{0x0304, Severity::end, "the driver has no timer for its servo loop", "start the driver again"},
    ErrorMeaning{0x0400, Severity::end, "a frame was begun twice", kReport},
    ErrorMeaning{0x0401, Severity::end, "a frame was ended that was not begun", kReport},
    ErrorMeaning{0x0402, Severity::end, "a call that needs a frame", kReport},
    ErrorMeaning{0x0500, Severity::end, "a priority that the scheduler does not accept", kReport},
    ErrorMeaning{0x0501, Severity::end, "the driver's scheduler is full", "close other programs that use it"},
    ErrorMeaning{0x0600, Severity::end, "the driver has no valid licence", "install the vendor's licence"},
};
constexpr ErrorMeaning kUnknown{0xFFFF, Severity::end, "an unknown error", "update the vendor's driver"};

}  // namespace

const ErrorMeaning& meaningOf(std::uint32_t code) {
  const auto found = std::ranges::find(kMeanings, code, &ErrorMeaning::code);
  return found == kMeanings.end() ? kUnknown : *found;
}

SymbolTable Api::fill(const VendorLibrary& library) {
  SymbolTable table(library);
  table.need(initDevice, "hdInitDevice");
  table.need(disableDevice, "hdDisableDevice");
  table.need(makeCurrentDevice, "hdMakeCurrentDevice");
  table.need(beginFrame, "hdBeginFrame");
  table.need(endFrame, "hdEndFrame");
  table.need(getError, "hdGetError");
  table.need(getErrorString, "hdGetErrorString");
  table.need(enable, "hdEnable");
  table.need(disable, "hdDisable");
  table.need(getIntegerv, "hdGetIntegerv");
  table.need(getDoublev, "hdGetDoublev");
  table.need(setDoublev, "hdSetDoublev");
  table.need(getString, "hdGetString");
  table.need(checkCalibration, "hdCheckCalibration");
  table.need(updateCalibration, "hdUpdateCalibration");
  table.need(startScheduler, "hdStartScheduler");
  table.need(stopScheduler, "hdStopScheduler");
  table.need(scheduleAsynchronous, "hdScheduleAsynchronous");
  table.need(unschedule, "hdUnschedule");
  table.need(waitForCompletion, "hdWaitForCompletion");
  table.offer(setSchedulerRate, "hdSetSchedulerRate");
  table.offer(checkCalibrationStyle, "hdCheckCalibrationStyle");
  return table;
}

Api::Api(const VendorLibrary& library) { fill(library).requireAll(kProduct); }

std::vector<std::string> Api::missingFrom(const VendorLibrary& library) { return Api().fill(library).missing(); }

const LibrarySearch& librarySearch() {
  static const LibrarySearch search{.product = kProduct,
                                    .variable = "PALPATE_HD_LIBRARY",
                                    .names = openHapticsNames(),
                                    .probe = "hdInitDevice",
                                    .advice = "install the Touch device driver and OpenHaptics from 3D Systems"};
  return search;
}

}  // namespace palpate::hdapi
