// The interface to the system's HID devices: their list, and reports in both directions.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpate {

/// One usage of a device; a device with several top-level collections is listed once for each of them.
struct HidInfo {
  std::string path;                    ///< of its node, for open()
  std::string maker, product, serial;  ///< as the device reports, UTF-8; may be empty
  std::uint16_t vendorId = 0, productId = 0;
  std::uint16_t usagePage = 0, usage = 0;  ///< HID Usage Tables; 0 if unknown
  bool bluetooth = false;                  ///< its reports differ from those over a cable
};

/// An open device; its destructor closes it.
class HidConnection {
 public:
  virtual ~HidConnection() = default;
  /// Waits for the next report, its number first, and returns its bytes: 0 after a timeout or an interrupting signal.
  /// Nothing: the device is gone.
  virtual std::optional<std::size_t> read(std::span<std::uint8_t> report, int timeout_ms) noexcept = 0;
  /// Sends a report, its number first; may take some ms. False: the device is gone. On the thread that reads.
  virtual bool write(std::span<const std::uint8_t> report) noexcept = 0;
  /// The same, best effort, from any thread, and from a signal handler in the middle of a write().
  virtual void writeFromSignal(std::span<const std::uint8_t> report) noexcept = 0;
};

struct HidOpening {
  std::unique_ptr<HidConnection> connection;  ///< null: opening failed
  bool denied = false;                        ///< it exists, but this user may not open it
  std::string why;                            ///< the system's own text
};

/// Thread-safe.
class HidTransport {
 public:
  virtual ~HidTransport() = default;
  virtual std::vector<HidInfo> enumerate() = 0;
  virtual HidOpening open(const std::string& path) = 0;
};

/// The real one, through hidapi. Several of them may exist at once.
std::shared_ptr<HidTransport> hidapiTransport();

}  // namespace palpate
