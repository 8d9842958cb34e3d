// A virtual 3D mouse in the kernel: through /dev/uhid, with the report descriptor of such devices.
#pragma once

#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// HID 1.11, section 6.2.2: a multi-axis controller; reports 1 (X, Y, Z), 2 (Rx, Ry, Rz), 3 (two buttons), and 4, an
/// output report for a lamp.
inline constexpr auto kSpaceMouseDescriptor = std::to_array<std::uint8_t>(
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

}  // namespace palpate
