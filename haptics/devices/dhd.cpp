#include "haptics/devices/dhd.hpp"

#include "haptics/devices/system_devices.hpp"

namespace palpate::dhd {
namespace {

constexpr std::string_view kProduct = "the Force Dimension library (libdhd)";

}  // namespace

SymbolTable Api::fill(const VendorLibrary& library) {
  SymbolTable table(library);
  table.need(openID, "dhdOpenID");
  table.need(close, "dhdClose");
  table.need(getPosition, "dhdGetPosition");
  table.need(setForce, "dhdSetForce");
  table.need(getButtonMask, "dhdGetButtonMask");
  table.need(enableForce, "dhdEnableForce");
  table.need(setWatchdog, "dhdSetWatchdog");
  table.offer(getSystemName, "dhdGetSystemName");
  table.offer(getSerialNumber, "dhdGetSerialNumber");
  table.offer(lastError, "dhdErrorGetLastStr");
  table.offer(getDeviceCount, "dhdGetDeviceCount");
  table.offer(getVersion, "dhdGetSDKVersion");
  return table;
}

Api::Api(const VendorLibrary& library) { fill(library).requireAll(kProduct); }

std::vector<std::string> Api::missingFrom(const VendorLibrary& library) { return Api().fill(library).missing(); }

const LibrarySearch& librarySearch() {
  static const LibrarySearch search{.product = kProduct,
                                    .variable = "PALPATE_DHD_LIBRARY",
                                    .names = forceDimensionNames(),
                                    .probe = "dhdOpenID",
                                    .advice = "install the Force Dimension SDK"};
  return search;
}

}  // namespace palpate::dhd
