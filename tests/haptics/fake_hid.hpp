// Simulated HID devices: the test sets what is plugged in and what they report, and reads what they were sent.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "haptics/devices/hid_transport.hpp"
#include "tests/haptics/remarks.hpp"

namespace palpate {

using Report = std::vector<std::uint8_t>;

/// Usages of a generic desktop device: a gamepad, a keyboard, a controller with many axes.
inline HidInfo desktopDevice(const std::string& path, const char* maker, const char* product, std::uint16_t vendorId,
                             std::uint16_t productId, std::uint16_t usage, const std::string& serial = "") {
  return {.path = path,
          .maker = maker,
          .product = product,
          .serial = serial,
          .vendorId = vendorId,
          .productId = productId,
          .usagePage = 1,
          .usage = usage};
}
inline HidInfo spaceMouse(const std::string& path = "/dev/hidraw3", const std::string& serial = "A1") {
  return desktopDevice(path, "3Dconnexion", "SpaceMouse Compact", 0x256f, 0xc635, 8, serial);
}
inline HidInfo dualSense() {
  return desktopDevice("/dev/hidraw5", "Sony", "DualSense Wireless Controller", 0x054c, 0x0ce6, 5);
}
inline HidInfo keyboard() { return desktopDevice("/dev/hidraw0", "Logitech", "Keyboard", 0x046d, 0xc31c, 6); }

class FakeHid final : public HidTransport {
 public:
  void plug(const HidInfo& info) {
    const std::scoped_lock lock(lock_);
    plugged_.push_back(info);
  }
  /// Readers and writers of the device get an error.
  void unplug(const std::string& path) {
    const std::scoped_lock lock(lock_);
    std::erase_if(plugged_, [&](const HidInfo& info) { return info.path == path; });
    for (Node* node : open_)
      if (node->path == path) node->gone = true;
    changed_.notify_all();
  }
  void deny(const std::string& path, bool denied = true) {
    const std::scoped_lock lock(lock_);
    std::erase(denied_, path);
    if (denied) denied_.push_back(path);
  }
  /// Sends a report to every open handle.
  void report(const std::string& path, const Report& bytes) {
    const std::scoped_lock lock(lock_);
    for (Node* node : open_)
      if (node->path == path) node->reports.push_back(bytes);
    changed_.notify_all();
  }
  /// Reports sent so far, separately for those from a signal handler.
  std::vector<Report> sent(const std::string& path, bool fromSignal = false) {
    const std::scoped_lock lock(lock_);
    std::vector<Report> all;
    for (const auto& [to, bytes, signal] : sent_)
      if (to == path && signal == fromSignal) all.push_back(bytes);
    return all;
  }
  std::size_t opened() {
    const std::scoped_lock lock(lock_);
    return open_.size();
  }

  std::vector<HidInfo> enumerate() override {
    const std::scoped_lock lock(lock_);
    return plugged_;
  }
  HidOpening open(const std::string& path) override {
    const std::scoped_lock lock(lock_);
    if (std::ranges::count(denied_, path)) return {.denied = true, .why = "Permission denied"};
    if (!std::ranges::count(plugged_, path, &HidInfo::path)) return {.why = "No such file or directory"};
    return {.connection = std::make_unique<Connection>(*this, path)};
  }

 private:
  struct Node {
    std::string path;
    std::deque<Report> reports;
    bool gone = false;
  };
  class Connection final : public HidConnection {
   public:
    Connection(FakeHid& all, const std::string& path) : all_(all), node_{.path = path} { all_.open_.push_back(&node_); }
    ~Connection() override {
      const std::scoped_lock lock(all_.lock_);
      std::erase(all_.open_, &node_);
    }
    std::optional<std::size_t> read(std::span<std::uint8_t> report, int timeout_ms) noexcept override {
      std::unique_lock lock(all_.lock_);
      all_.changed_.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                             [&] { return node_.gone || !node_.reports.empty(); });
      if (node_.gone) return std::nullopt;
      if (node_.reports.empty()) return 0;
      const Report bytes = node_.reports.front();
      node_.reports.pop_front();
      const std::size_t count = std::min(bytes.size(), report.size());
      std::copy_n(bytes.begin(), count, report.begin());
      return count;
    }
    bool write(std::span<const std::uint8_t> report) noexcept override { return take(report, false); }
    void writeFromSignal(std::span<const std::uint8_t> report) noexcept override { take(report, true); }

   private:
    bool take(std::span<const std::uint8_t> report, bool fromSignal) {
      const std::scoped_lock lock(all_.lock_);
      if (node_.gone) return false;
      all_.sent_.push_back({node_.path, Report(report.begin(), report.end()), fromSignal});
      return true;
    }
    FakeHid& all_;
    Node node_;
  };
  struct Sent {
    std::string path;
    Report bytes;
    bool fromSignal;
  };

  std::mutex lock_;
  std::condition_variable changed_;
  std::vector<HidInfo> plugged_;
  std::vector<std::string> denied_;
  std::vector<Node*> open_;
  std::vector<Sent> sent_;
};

/// Waits for other threads, as long as a loaded machine may take; returns whether the condition became true.
inline bool comesTrue(const auto& condition, double within_s = 20) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(within_s);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace palpate
