// A device that may be unplugged at any time and comes back.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string_view>

#include "engine/core/clock.hpp"
#include "haptics/devices/hid_transport.hpp"

namespace palpate {

/// Receives what a person should read, a sentence at a time, from threads of the devices; throws nothing.
using HidRemark = std::function<void(std::string_view sentence)>;

/// For one thread. The same device is one with the same kind, numbers and, where it has one, serial number, wherever it
/// is plugged in.
class HidLink {
 public:
  /// Opens it. `whileGone` goes on from "... was unplugged: ". Throws Error where it cannot be opened.
  HidLink(std::shared_ptr<HidTransport> transport, HidInfo device, HidRemark remark, std::string whileGone);

  const HidInfo& device() const { return device_; }
  /// Null while it is unplugged.
  HidConnection* connection() { return connection_.get(); }

  /// A read or write said that it is gone.
  void lose();
  /// Looks for it again, at most every half second, less often while it comes and goes; true where
  /// it is back.
  bool find();
  /// Until it is time to look again, or to stop.
  void rest(const std::stop_token& stop);

 private:
  bool isSame(const HidInfo& other) const;

  std::shared_ptr<HidTransport> transport_;
  HidInfo device_;
  HidRemark remark_;
  std::string whileGone_;
  std::unique_ptr<HidConnection> connection_;
  Stopwatch searched_, absent_, found_;  // since it was looked for, was not there, came back
  double wait_s_;                        // until the next look
  bool complained_ = false;              // that it is there and cannot be opened
  std::mutex restLock_;
  std::condition_variable_any stopped_;
};

}  // namespace palpate
