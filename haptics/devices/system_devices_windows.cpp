#include "haptics/devices/system_devices.hpp"

#include <windows.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace palpate {

namespace fs = std::filesystem;

std::span<const std::string_view> openHapticsNames() {
  static constexpr std::array<std::string_view, 2> kNames{"HD.dll", ""};
  return kNames;
}

std::span<const std::string_view> forceDimensionNames() {
  static constexpr std::array<std::string_view, 3> kNames{"dhd64.dll", "drd64.dll", ""};
  return kNames;
}

TouchConfiguration touchConfiguration() {
  TouchConfiguration found{.folders = {}, .inWords = "%GTDD_HOME%\\config or 3DSystems in the public documents"};
  if (const wchar_t* own = ::_wgetenv(L"GTDD_HOME")) found.folders.push_back(fs::path(own) / "config");
  if (const wchar_t* common = ::_wgetenv(L"PUBLIC"))
    found.folders.push_back(fs::path(common) / "Documents" / "3DSystems");
  return found;
}

fs::path userConfiguration() {
  const wchar_t* data = ::_wgetenv(L"APPDATA");
  return data ? fs::path(data) : fs::path();
}

fs::path haplyConfiguration() {
  const wchar_t* data = ::_wgetenv(L"PROGRAMDATA");
  return fs::path(data ? data : L"C:\\ProgramData") / "Haply" / "Inverse" / "haply-inverse-service-config.json";
}

std::string_view haplyStart() { return "open the Haply Hub, or the list of services (services.msc)"; }

// From the registry; ports of USB modems, such as a Touch, have names of that driver.
std::vector<NodeFinding> surveySerialPorts() {
  std::vector<NodeFinding> found;
  HKEY ports = nullptr;
  if (::RegOpenKeyExA(HKEY_LOCAL_MACHINE, "HARDWARE\\DEVICEMAP\\SERIALCOMM", 0, KEY_READ, &ports) != ERROR_SUCCESS)
    return found;
  std::array<char, 256> name{}, port{};
  for (DWORD i = 0;; ++i) {
    DWORD nameLength = name.size(), portLength = port.size() - 1;
    const LONG more = ::RegEnumValueA(ports, i, name.data(), &nameLength, nullptr, nullptr,
                                      reinterpret_cast<BYTE*>(port.data()), &portLength);
    if (more != ERROR_SUCCESS) break;
    port[portLength] = 0;
    if (std::string_view(name.data(), nameLength).starts_with("\\Device\\USBSER"))
      found.push_back(
          {.path = port.data(), .what = "a serial port over USB; a Touch may be behind it", .usable = true});
  }
  ::RegCloseKey(ports);
  std::ranges::sort(found, {}, &NodeFinding::path);
  return found;
}

}  // namespace palpate
