#include "haptics/devices/hid_node.hpp"

#include <windows.h>

namespace palpate {

namespace {

constexpr DWORD kShared = FILE_SHARE_READ | FILE_SHARE_WRITE;

HANDLE opened(const std::string& path, DWORD access) noexcept {
  return ::CreateFileA(path.c_str(), access, kShared, nullptr, OPEN_EXISTING, 0, nullptr);
}

}  // namespace

HidNode::HidNode(const std::string& path) noexcept
    : file_(reinterpret_cast<std::intptr_t>(opened(path, GENERIC_WRITE))) {}

HidNode::~HidNode() {
  const auto file = reinterpret_cast<HANDLE>(file_);
  if (file != INVALID_HANDLE_VALUE) ::CloseHandle(file);
}

void HidNode::write(std::span<const std::uint8_t> report) noexcept {
  const auto file = reinterpret_cast<HANDLE>(file_);
  DWORD written = 0;
  if (file != INVALID_HANDLE_VALUE)
    ::WriteFile(file, report.data(), static_cast<DWORD>(report.size()), &written, nullptr);
}

bool HidNode::isDenied(const std::string& path) noexcept {
  const HANDLE file = opened(path, GENERIC_READ | GENERIC_WRITE);
  if (file == INVALID_HANDLE_VALUE)
    return ::GetLastError() == ERROR_ACCESS_DENIED || ::GetLastError() == ERROR_SHARING_VIOLATION;
  ::CloseHandle(file);
  return false;
}

// Windows gives every user access to HID devices: a denied one is open exclusively elsewhere.
std::string hidPermissionMend(const std::string&, bool) { return "close the program that uses it exclusively"; }

}  // namespace palpate
