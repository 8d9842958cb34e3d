#include <hidapi.h>

#include <cerrno>
#include <mutex>

#include "haptics/devices/hid_node.hpp"
#include "haptics/devices/hid_transport.hpp"

namespace palpate {
namespace {

/// hidapi has one error text per process for listing, opening and closing, which two threads would free twice.
std::mutex& hidapiLock() {
  static std::mutex lock;
  return lock;
}

/// Independent of the locale: hidapi gives code points, or pairs of UTF-16 if wchar_t is too small for them.
std::string utf8(const wchar_t* text) {
  std::string out;
  for (; text && *text; ++text) {
    // NOLINTBEGIN(bugprone-signed-char-misuse): wchar_t is not a char
    auto code = static_cast<std::uint32_t>(*text);
    if ((code & 0xfffffc00) == 0xd800 && (static_cast<std::uint32_t>(text[1]) & 0xfffffc00) == 0xdc00)
      code = 0x10000 + ((code & 0x3ff) << 10) + (static_cast<std::uint32_t>(*++text) & 0x3ff);
    // NOLINTEND(bugprone-signed-char-misuse)
    const auto add = [&](std::uint32_t lead, int shift) {
      out += static_cast<char>(lead | (code >> shift));
      for (shift -= 6; shift >= 0; shift -= 6) out += static_cast<char>(0x80 | ((code >> shift) & 0x3f));
    };
    if (code < 0x20 || code == 0x7f || code > 0x10ffff)
      out += '?';  // no control characters for a terminal
    else if (code < 0x80)
      out += static_cast<char>(code);
    else if (code < 0x800)
      add(0xc0, 6);
    else if (code < 0x10000)
      add(0xe0, 12);
    else
      add(0xf0, 18);
  }
  return out;
}

class HidapiConnection final : public HidConnection {
 public:
  HidapiConnection(hid_device* device, const std::string& path) : device_(device), node_(path) {}
  ~HidapiConnection() override {
    const std::scoped_lock lock(hidapiLock());
    ::hid_close(device_);
  }
  HidapiConnection(const HidapiConnection&) = delete;
  HidapiConnection& operator=(const HidapiConnection&) = delete;

  std::optional<std::size_t> read(std::span<std::uint8_t> report, int timeout_ms) noexcept override {
    errno = 0;
    const int bytes = ::hid_read_timeout(device_, report.data(), report.size(), timeout_ms);
    if (bytes >= 0) return static_cast<std::size_t>(bytes);
    if (errno == EINTR) return 0;  // a signal does not mean unplugged
    return std::nullopt;
  }

  bool write(std::span<const std::uint8_t> report) noexcept override {
    for (;;) {
      errno = 0;
      if (::hid_write(device_, report.data(), report.size()) >= 0) return true;
      if (errno != EINTR) return false;
    }
  }

  void writeFromSignal(std::span<const std::uint8_t> report) noexcept override { node_.write(report); }

 private:
  hid_device* device_;
  HidNode node_;
};

class HidapiTransport final : public HidTransport {
 public:
  std::vector<HidInfo> enumerate() override {
    const std::scoped_lock lock(hidapiLock());
    const std::unique_ptr<hid_device_info, decltype(&::hid_free_enumeration)> all(::hid_enumerate(0, 0),
                                                                                  ::hid_free_enumeration);
    std::vector<HidInfo> found;
    for (const hid_device_info* one = all.get(); one; one = one->next)
      if (one->path)
        found.push_back({.path = one->path,
                         .maker = utf8(one->manufacturer_string),
                         .product = utf8(one->product_string),
                         .serial = utf8(one->serial_number),
                         .vendorId = one->vendor_id,
                         .productId = one->product_id,
                         .usagePage = one->usage_page,
                         .usage = one->usage,
                         .bluetooth = one->bus_type == HID_API_BUS_BLUETOOTH});
    return found;
  }

  HidOpening open(const std::string& path) override {
    const std::scoped_lock lock(hidapiLock());
    if (hid_device* device = ::hid_open_path(path.c_str()))
      return {.connection = std::make_unique<HidapiConnection>(device, path)};
    std::string why = utf8(::hid_error(nullptr));
    if (const auto cause = why.rfind(": "); cause != std::string::npos) why.erase(0, cause + 2);  // without the path
    return {.denied = HidNode::isDenied(path), .why = why};
  }
};

}  // namespace

std::shared_ptr<HidTransport> hidapiTransport() { return std::make_shared<HidapiTransport>(); }

}  // namespace palpate
