#include <algorithm>

#include "haptics/devices/hid_motion.hpp"

namespace palpate {
namespace {

constexpr std::uint8_t kTranslation = 1, kRotation = 2, kButtons = 3;
constexpr std::size_t kOneTriple = 7, kTwoTriples = 13;  // bytes of a report, with its number
constexpr double kFullScale = 350;

/// Three numbers of a device, in palpate's axes and -1 to 1. Rotations are converted like translations: both are
/// right-handed around the device's axes.
DVec3 tripleAt(std::span<const std::uint8_t> report, std::size_t first) {
  const auto number = [&](std::size_t k) {
    const auto bits = static_cast<std::uint16_t>(report[first + 2 * k] | (report[first + 2 * k + 1] << 8));
    return std::clamp(static_cast<std::int16_t>(bits) / kFullScale, -1.0, 1.0);
  };
  return {number(0), -number(2), number(1)};
}

}  // namespace

bool takeSpaceMouseReport(std::span<const std::uint8_t> report, HidMotion& motion) noexcept {
  if (report.size() < 2) return false;
  switch (report[0]) {
    case kTranslation:
      if (report.size() < kOneTriple) return false;
      motion.push = tripleAt(report, 1);
      if (report.size() >= kTwoTriples) motion.turn = tripleAt(report, kOneTriple);
      return true;
    case kRotation:
      if (report.size() < kOneTriple) return false;
      motion.turn = tripleAt(report, 1);
      return true;
    case kButtons:
      motion.buttons = 0;
      for (std::size_t k = 1; k < std::min<std::size_t>(report.size(), 5); ++k)
        motion.buttons |= static_cast<std::uint32_t>(report[k]) << (8 * (k - 1));
      return true;
    default:
      return false;
  }
}

}  // namespace palpate
