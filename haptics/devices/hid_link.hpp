// A device that may be unplugged and plugged in again at any time.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string_view>

#include "engine/core/clock.hpp"
#include "haptics/devices/hid_transport.hpp"

namespace palpate {

/// Receives messages for the user, a sentence at a time, on threads of the devices; must not throw.
using HidRemark = std::function<void(std::string_view sentence)>;

/// Not thread-safe. A device is recognized by its kind, its ids and, if it has one, its serial number, on any port.
class HidLink {
 public:
  /// Opens it. `whileGone` continues the sentence "... was unplugged: ". Throws Error if it cannot be opened.
  HidLink(std::shared_ptr<HidTransport> transport, HidInfo device, HidRemark remark, std::string whileGone);

  const HidInfo& device() const { return device_; }
  /// Null while it is unplugged.
  HidConnection* connection() { return connection_.get(); }

  /// A read or write has reported that it is gone.
  void lose();
  /// Searches for it, at most every half second, less often after short connections; true if it is back.
  bool find();
  /// Sleeps until the next search is due, or until a stop.
  void rest(const std::stop_token& stop);

 private:
  bool isSame(const HidInfo& other) const;

  std::shared_ptr<HidTransport> transport_;
  HidInfo device_;
  HidRemark remark_;
  std::string whileGone_;
  std::unique_ptr<HidConnection> connection_;
  Stopwatch searched_, absent_, found_;  // since the last search, since it was last missing, since it came back
  double wait_s_;                        // until the next search
  bool complained_ = false;              // the log says that it is present and cannot be opened
  std::mutex restLock_;
  std::condition_variable_any stopped_;
};

}  // namespace palpate
