// The real transport: through hidapi and the kernel to a virtual device.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptics/devices/hid_choice.hpp"
#include "haptics/devices/hid_device.hpp"
#include "tests/haptics/fake_hid.hpp"

namespace palpate::hidapi_transport_test {

namespace {

/// A virtual 3D mouse in the kernel: through /dev/uhid, with the report descriptor of such devices.
/// HID 1.11, section 6.2.2: a multi-axis controller; reports 1 (X, Y, Z), 2 (Rx, Ry, Rz), 3 (two buttons), and 4, an
/// output report for a lamp.
constexpr auto kSpaceMouseDescriptor = std::to_array<std::uint8_t>(
    {0x05, 0x01, 0x09, 0x08, 0xa1, 0x01,                          // Generic Desktop, Multi-axis Controller, application
     0xa1, 0x00, 0x85, 0x01, 0x16, 0xa2, 0xfe, 0x26, 0x5e, 0x01,  // report 1, -350 to 350
     0x36, 0x88, 0xfa, 0x46, 0x78, 0x05, 0x55, 0x0c, 0x65, 0x11,  // -1400 to 1400, micrometres
     0x09, 0x30, 0x09, 0x31, 0x09, 0x32,                          // X, Y, Z
     0x75, 0x10, 0x95, 0x03, 0x81, 0x02, 0xc0,                    // three of 16 bits, absolute
     0xa1, 0x00, 0x85, 0x02, 0x16, 0xa2, 0xfe, 0x26, 0x5e, 0x01,  // report 2
     0x36, 0x88, 0xfa, 0x46, 0x78, 0x05, 0x55, 0x0c, 0x65, 0x11,  //
     0x09, 0x33, 0x09, 0x34, 0x09, 0x35,                          // Rx, Ry, Rz
     0x75, 0x10, 0x95, 0x03, 0x81, 0x02, 0xc0,                    //
     0xa1, 0x02, 0x85, 0x03, 0x05, 0x09, 0x19, 0x01, 0x29, 0x02,  // report 3: buttons 1 and 2
     0x15, 0x00, 0x25, 0x01, 0x35, 0x00, 0x45, 0x01, 0x75, 0x01,  //
     0x95, 0x02, 0x81, 0x02, 0x95, 0x0e, 0x81, 0x03, 0xc0,        // and 14 bits of nothing
     0xa1, 0x02, 0x85, 0x04, 0x05, 0x08, 0x09, 0x4b,              // report 4: a lamp
     0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x01, 0x91, 0x02,  //
     0x95, 0x07, 0x91, 0x03, 0xc0, 0xc0});

class UhidMouse {
 public:
  /// Null with the reason if uhid is not available to this user.
  static std::unique_ptr<UhidMouse> plugIn(const std::string& serial, std::string& why) {
    const int file = ::open("/dev/uhid", O_RDWR | O_CLOEXEC);
    if (file < 0) {
      why = std::string("/dev/uhid: ") + std::strerror(errno);
      return nullptr;
    }
    auto mouse = std::unique_ptr<UhidMouse>(new UhidMouse(file));
    uhid_event event{};
    event.type = UHID_CREATE2;
    std::memcpy(event.u.create2.name, kName.data(), kName.size());
    std::memcpy(event.u.create2.uniq, serial.data(), std::min(serial.size(), sizeof(event.u.create2.uniq) - 1));
    event.u.create2.rd_size = kSpaceMouseDescriptor.size();
    std::memcpy(event.u.create2.rd_data, kSpaceMouseDescriptor.data(), kSpaceMouseDescriptor.size());
    event.u.create2.bus = 3;  // USB
    event.u.create2.vendor = 0x256f;
    event.u.create2.product = 0xc635;
    if (mouse->send(event)) return mouse;
    why = std::string("creating a device: ") + std::strerror(errno);
    return nullptr;
  }
  /// Unplugs it.
  ~UhidMouse() { ::close(file_); }
  UhidMouse(const UhidMouse&) = delete;
  UhidMouse& operator=(const UhidMouse&) = delete;

  bool report(const std::vector<std::uint8_t>& bytes) {
    uhid_event event{};
    event.type = UHID_INPUT2;
    event.u.input2.size = static_cast<std::uint16_t>(bytes.size());
    std::memcpy(event.u.input2.data, bytes.data(), bytes.size());
    return send(event);
  }

  /// The next report sent to the device; empty if none arrives within a second.
  std::optional<std::vector<std::uint8_t>> received() {
    for (pollfd ready{.fd = file_, .events = POLLIN}; ::poll(&ready, 1, 1000) > 0;) {
      uhid_event event{};
      if (::read(file_, &event, sizeof(event)) <= 0) break;
      if (event.type == UHID_OUTPUT)
        return std::vector<std::uint8_t>(event.u.output.data, event.u.output.data + event.u.output.size);
    }
    return std::nullopt;
  }

 private:
  explicit UhidMouse(int file) : file_(file) {}
  static constexpr std::string_view kName = "Virtual SpaceMouse";
  bool send(const uhid_event& event) { return ::write(file_, &event, sizeof(event)) == sizeof(event); }

  int file_;
};

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
