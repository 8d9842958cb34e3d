// The real transport: through hidapi and the kernel to a virtual device.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "haptics/devices/hid_choice.hpp"
#include "haptics/devices/hid_device.hpp"
#include "tests/haptics/fake_hid.hpp"
#include "tests/haptics/uhid_mouse.hpp"

namespace palpate::hidapi_transport_test {
namespace {

const std::string kSerial = "palpate-test-" + std::to_string(::getpid());

std::optional<HidInfo> find(HidTransport& transport) {
  for (const HidInfo& info : transport.enumerate())
    if (info.serial == kSerial) return info;
  return std::nullopt;
}

/// A virtual 3D mouse that hidapi can open; null, with a message, if this machine cannot provide one.
std::unique_ptr<UhidMouse> plugIn(HidTransport& transport) {
  std::string why;
  auto mouse = UhidMouse::plugIn(kSerial, why);
  if (!mouse) {
    MESSAGE("skipped: this machine cannot create a virtual 3D mouse; " << why);
    return nullptr;
  }
  const auto hasNode = [&] {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/sys/class/hidraw", ignored))
      if (std::filesystem::read_symlink(entry, ignored).string().find(":256F:C635.") != std::string::npos &&
          std::filesystem::exists("/dev" / entry.path().filename()))
        return true;
    return false;
  };
  if (!comesTrue(hasNode, 10)) {
    MESSAGE("skipped: the kernel created a virtual 3D mouse without a /dev/hidraw node");
    return nullptr;
  }
  CHECK(comesTrue([&] { return find(transport).has_value(); }, 30));
  return mouse;
}

}  // namespace

TEST_CASE("several threads can list the devices, and a missing device does not open") {
  const auto transport = hidapiTransport();
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([] {
      const auto own = hidapiTransport();
      for (int k = 0; k < 20; ++k) {
        own->enumerate();
        own->open("/dev/no-such-hidraw");
      }
    });
  threads.clear();
  const HidOpening opening = transport->open("/dev/no-such-hidraw");
  CHECK(!opening.connection);
  CHECK(!opening.denied);
  CHECK(opening.why.find("No such file") != std::string::npos);
  for (const HidCandidate& one : hidCandidates(*transport))
    MESSAGE(one.name << " at " << one.info.path << ": " << (one.usable ? "usable" : one.whyNot + "; " + one.mend));
}

TEST_CASE("a virtual 3D mouse is listed with its properties, steers, and is detected as lost and found again") {
  const auto transport = hidapiTransport();
  auto mouse = plugIn(*transport);
  if (!mouse) return;
  const auto info = find(*transport);
  REQUIRE(info);
  CHECK(info->vendorId == 0x256f);
  CHECK(info->productId == 0xc635);
  CHECK(info->usagePage == 1);
  CHECK(info->usage == 8);
  CHECK(kindOf(*info) == HidKind::spaceMouse);
  MESSAGE("virtual 3D mouse: " << nameOf(*info) << " at " << info->path);
  CHECK(chooseHidSteering(*transport, kSerial).path == info->path);

  Remarks remarks;
  HidDevice device(transport, *info, DVec3(0), remarks.sink());
  double time_s = 0;
  const auto stateAfter = [&](double span_s) {
    DeviceState state = device.read(time_s);
    for (const double end_s = time_s + span_s; time_s < end_s; state = device.read(time_s)) time_s += 1e-3;
    return state;
  };
  stateAfter(0.6);
  const auto pushes = [&](const std::vector<std::uint8_t>& report, std::uint8_t buttons) {
    CHECK(mouse->report(report));
    CHECK(mouse->report({3, buttons, 0}));
    REQUIRE(comesTrue([&] { return device.read(time_s).buttons == buttons; }));
  };
  pushes({1, 0x5e, 1, 0, 0, 0, 0}, 1);
  CHECK(stateAfter(0.3).position.x > 15);
  pushes({1, 0, 0, 0, 0, 0xa2, 0xfe}, 2);
  CHECK(stateAfter(0.3).position.y > 15);

  mouse.reset();
  REQUIRE(comesTrue([&] { return !device.read(time_s).rendersForce; }));
  const DVec3 left = device.read(time_s).position;
  CHECK(stateAfter(0.3).position == left);
  CHECK(comesTrue([&] { return remarks.count("was unplugged") == 1; }));
  mouse = plugIn(*transport);
  REQUIRE(mouse);
  REQUIRE(comesTrue([&] { return device.read(time_s).rendersForce; }));
  CHECK(remarks.count("is back") == 1);
  stateAfter(0.6);
  pushes({1, 0xa2, 0xfe, 0, 0, 0, 0}, 3);
  CHECK(stateAfter(0.3).position.x < left.x - 15);
}

TEST_CASE("a report reaches the device, written normally and from a signal handler") {
  const auto transport = hidapiTransport();
  const auto mouse = plugIn(*transport);
  if (!mouse) return;
  const HidOpening opening = transport->open(find(*transport)->path);
  REQUIRE(opening.connection);
  CHECK(opening.connection->write(Report{4, 1}));
  CHECK(mouse->received() == Report{4, 1});
  opening.connection->writeFromSignal(Report{4, 0});
  CHECK(mouse->received() == Report{4, 0});
  std::array<std::uint8_t, 64> report;
  CHECK(opening.connection->read(report, 20) == std::size_t{0});
  CHECK(mouse->report({2, 1, 2, 3, 4, 5, 6}));
  CHECK(opening.connection->read(report, 30'000) == std::size_t{7});
  CHECK(report[0] == 2);
  CHECK(report[6] == 6);
}

}  // namespace palpate::hidapi_transport_test
