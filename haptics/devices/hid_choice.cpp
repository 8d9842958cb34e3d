#include "haptics/devices/hid_choice.hpp"

#include <algorithm>
#include <array>

#include "engine/core/error.hpp"
#include "haptics/devices/dualsense_report.hpp"
#include "haptics/devices/hid_node.hpp"

namespace palpate {
namespace {

constexpr std::uint16_t kGenericDesktop = 1, kGamepad = 5, kMultiAxis = 8;  // HID Usage Tables 1.4, section 4
constexpr std::uint16_t kLogitech = 0x046d, k3Dconnexion = 0x256f, k3DSystems = 0x2988;

// 3D mice with Logitech's vendor id, which its keyboards and mice share.
constexpr std::array<std::uint16_t, 12> kLogitech3DMice{0xc603, 0xc605, 0xc606, 0xc621, 0xc623, 0xc625,
                                                        0xc626, 0xc627, 0xc628, 0xc629, 0xc62b, 0xc640};

/// Whether third_party/70-palpate.rules gives users access to it.
bool isInRule(const HidInfo& info) {
  const bool logitech = info.vendorId == kLogitech && std::ranges::count(kLogitech3DMice, info.productId);
  return logitech || info.vendorId == k3Dconnexion || info.vendorId == k3DSystems || kindOf(info) == HidKind::dualSense;
}

HidCandidate candidate(HidTransport& transport, const HidInfo& info, HidKind kind) {
  HidCandidate one{.info = info, .kind = kind, .name = nameOf(info)};
  if (kind == HidKind::dualSense && info.bluetooth) {
    one.whyNot = "connected by Bluetooth";
    one.mend = "connect it by its cable";
    return one;
  }
  const HidOpening opening = transport.open(info.path);
  one.usable = opening.connection != nullptr;
  if (one.usable) return one;
  one.whyNot = opening.why;
  one.mend = opening.denied ? hidPermissionMend(info.path, isInRule(info)) : "plug it in again";
  return one;
}

std::string hex4(std::uint16_t number) { return fmt::format("{:04x}", number); }

bool isMeant(const HidInfo& info, std::string_view wanted) {
  if (wanted.empty() || wanted == info.path || (!info.serial.empty() && wanted == info.serial)) return true;
  const std::string ids = hex4(info.vendorId) + ":" + hex4(info.productId);
  return std::ranges::equal(wanted, ids, {}, [](char c) { return c >= 'A' && c <= 'F' ? c - 'A' + 'a' : c; });
}

std::string seen(const std::vector<HidInfo>& all) {
  std::string text;
  for (const HidInfo& info : all)
    text += fmt::format("{}{} with usage {}/{} at {}", text.empty() ? "" : ", ", nameOf(info), info.usagePage,
                        info.usage, info.path);
  return text.empty() ? "there is no HID device at all" : "seen: " + text;
}

HidInfo choose(HidTransport& transport, std::string_view wanted, std::string_view lookedFor,
               std::initializer_list<HidKind> kinds) {
  const std::vector<HidCandidate> all = hidCandidates(transport);
  const HidCandidate* unusable = nullptr;
  for (const HidKind kind : kinds)
    for (const HidCandidate& one : all) {
      if (one.kind != kind || !isMeant(one.info, wanted)) continue;
      if (one.usable) return one.info;
      if (!unusable) unusable = &one;
    }
  if (unusable)
    throw Error("{} at {} cannot be used: {}; {}", unusable->name, unusable->info.path, unusable->whyNot,
                unusable->mend);
  const std::string named = wanted.empty() ? "" : fmt::format(" that is '{}'", wanted);
  throw Error("there is no {}{}; {}; plug one in", lookedFor, named, seen(transport.enumerate()));
}

}  // namespace

HidKind kindOf(const HidInfo& info) noexcept {
  const bool sony = info.vendorId == kSony && (info.productId == kDualSense || info.productId == kDualSenseEdge);
  if (sony && (info.usagePage == 0 || (info.usagePage == kGenericDesktop && info.usage == kGamepad)))
    return HidKind::dualSense;
  if (info.usagePage == kGenericDesktop && info.usage == kMultiAxis) return HidKind::spaceMouse;
  if (info.vendorId == k3DSystems) return HidKind::hapticStylus;
  return HidKind::none;
}

std::string nameOf(const HidInfo& info) {
  std::string name = info.product;
  if (name.empty()) {
    name = info.maker;
    if (name.empty() && info.vendorId == k3Dconnexion) name = "3Dconnexion";
    if (name.empty() && info.vendorId == kLogitech) name = "Logitech";
    const HidKind kind = kindOf(info);
    const std::string_view what = kind == HidKind::spaceMouse     ? "3D mouse"
                                  : kind == HidKind::dualSense    ? "DualSense"
                                  : kind == HidKind::hapticStylus ? "3D Systems stylus"
                                                                  : "device";
    name += fmt::format("{}{}", name.empty() ? "" : " ", what);
  }
  return fmt::format("{} ({}:{})", name, hex4(info.vendorId), hex4(info.productId));
}

std::vector<HidCandidate> hidCandidates(HidTransport& transport) {
  std::vector<HidCandidate> found;
  for (const HidInfo& info : transport.enumerate()) {
    const HidKind kind = kindOf(info);
    const bool known = std::ranges::count(found, info.path, [](const HidCandidate& one) { return one.info.path; }) > 0;
    if (kind != HidKind::none && !known) found.push_back(candidate(transport, info, kind));
  }
  return found;
}

HidInfo chooseHidSteering(HidTransport& transport, std::string_view wanted) {
  return choose(transport, wanted, "3D mouse (usage 1/8) and no DualSense", {HidKind::spaceMouse, HidKind::dualSense});
}

HidInfo chooseDualSense(HidTransport& transport) {
  return choose(transport, {}, "DualSense to rumble", {HidKind::dualSense});
}

}  // namespace palpate
