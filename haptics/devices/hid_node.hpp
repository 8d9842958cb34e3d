#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace palpate {

/// An open HID device beside hidapi, which allocates when it writes and hides its file: the system accepts the same
/// report from any process that has opened the device.
class HidNode {
 public:
  explicit HidNode(const std::string& path) noexcept;
  ~HidNode();
  HidNode(const HidNode&) = delete;
  HidNode& operator=(const HidNode&) = delete;

  /// From any thread and any signal handler; best effort.
  void write(std::span<const std::uint8_t> report) noexcept;

  /// Whether the device exists but this user may not open it.
  static bool isDenied(const std::string& path) noexcept;

 private:
  std::intptr_t file_;
};

/// How this user gets access to a denied device; `inRule`: third_party/70-palpate.rules gives users access to it.
std::string hidPermissionMend(const std::string& path, bool inRule);

}  // namespace palpate
