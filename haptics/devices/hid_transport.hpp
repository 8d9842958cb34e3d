// The seam to the system's HID devices: what is plugged in, and the bytes that go to and fro.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpate {

/// One use of a device; a device with several top-level collections is listed once for each of them.
struct HidInfo {
  std::string path;                    ///< of its node, as open() wants it
  std::string maker, product, serial;  ///< as the device says, UTF-8; may be empty
  std::uint16_t vendorId = 0, productId = 0;
  std::uint16_t usagePage = 0, usage = 0;  ///< what it is (HID Usage Tables); 0 where nobody says
  bool bluetooth = false;                  ///< its reports differ from those over a cable
};

/// An open device. Closes when it goes.
class HidConnection {
 public:
  virtual ~HidConnection() = default;
  /// Waits for the next report, its number first, and says how many bytes it has: 0 when none came in time or a signal
  /// came between. Nothing: the device is gone.
  virtual std::optional<std::size_t> read(std::span<std::uint8_t> report, int timeout_ms) noexcept = 0;
  /// Sends a report, its number first; may take some ms. False: the device is gone. From the thread that reads.
  virtual bool write(std::span<const std::uint8_t> report) noexcept = 0;
  /// The same as far as it goes, from any thread, and from a signal handler in the middle of a write().
  virtual void writeFromSignal(std::span<const std::uint8_t> report) noexcept = 0;
};

struct HidOpening {
  std::unique_ptr<HidConnection> connection;  ///< null: see below
  bool denied = false;                        ///< it is there, but not for this user
  std::string why;                            ///< the system's own words
};

/// From any thread.
class HidTransport {
 public:
  virtual ~HidTransport() = default;
  virtual std::vector<HidInfo> enumerate() = 0;
  virtual HidOpening open(const std::string& path) = 0;
};

/// The real one, through hidapi. Any number of them may be there at once.
std::shared_ptr<HidTransport> hidapiTransport();

}  // namespace palpate
