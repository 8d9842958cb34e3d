#include "haptics/devices/dualsense_report.hpp"

#include <utility>

#include "haptics/devices/hid_motion.hpp"

namespace palpate {
namespace {

constexpr std::uint8_t kInput = 1, kOutput = 2;
constexpr std::size_t kInputBytes = 64;         // over USB; the short form of Bluetooth has 10
constexpr double kStickCentre = 127.5;          // of 0 to 255
constexpr std::uint8_t kMotorsAsSaid = 0x01;    // in byte 1: the motors follow bytes 3 and 4,
constexpr std::uint8_t kMotorsNotSound = 0x02;  // and not sound that is played to them
constexpr std::uint8_t kMotorsAsSaid2 = 0x04;   // in byte 39: the same for controllers that ignore the first
constexpr std::size_t kFlags = 1, kRight = 3, kLeft = 4, kFlags2 = 39;

}  // namespace

bool takeDualSenseReport(std::span<const std::uint8_t> report, HidMotion& motion) noexcept {
  if (report.size() < kInputBytes || report[0] != kInput) return false;
  const auto stick = [&](std::size_t k) { return report[k] / kStickCentre - 1; };  // left or up is -1
  motion.push = {stick(1), -stick(2), stick(4)};
  motion.turn = DVec3(0);
  constexpr std::array<std::pair<std::size_t, int>, 6> kButtonBits{
      {{8, 0x20}, {8, 0x40}, {8, 0x10}, {8, 0x80}, {9, 0x01}, {9, 0x02}}};
  motion.buttons = 0;
  for (std::size_t k = 0; k < kButtonBits.size(); ++k)
    if (report[kButtonBits[k].first] & kButtonBits[k].second) motion.buttons |= 1u << k;
  return true;
}

std::array<std::uint8_t, 48> dualSenseRumble(RumbleMotors motors, std::uint16_t productId) noexcept {
  std::array<std::uint8_t, 48> report{};
  report[0] = kOutput;
  report[kFlags] = kMotorsNotSound;
  if (productId == kDualSenseEdge)
    report[kFlags2] = kMotorsAsSaid2;
  else
    report[kFlags] |= kMotorsAsSaid;
  report[kRight] = motors.weak;
  report[kLeft] = motors.strong;
  return report;
}

}  // namespace palpate
