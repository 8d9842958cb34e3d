#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace palpate {

/// An open HID device beside hidapi, which allocates when it writes, and does not show its file: the system takes the
/// same report from anybody who has the device open.
class HidNode {
 public:
  explicit HidNode(const std::string& path) noexcept;
  ~HidNode();
  HidNode(const HidNode&) = delete;
  HidNode& operator=(const HidNode&) = delete;

  /// From any thread and any handler; goes as far as it goes.
  void write(std::span<const std::uint8_t> report) noexcept;

  /// Whether a device is there, but not for this user.
  static bool isDenied(const std::string& path) noexcept;

 private:
  std::intptr_t file_;
};

/// What lets this user open a device that is denied; `inRule`: third_party/70-palpate.rules opens it to users.
std::string hidPermissionMend(const std::string& path, bool inRule);

}  // namespace palpate
