// A network without other test programs, and sessions served on it for the duration of a test.
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "haptics/sharing/shared_cloud.hpp"
#include "tests/own_domain.hpp"

namespace palpate {

inline NetworkConfig ownNetwork() { return {.domain = ownDomain()}; }

class Served {
 public:
  explicit Served(const PointCloud& cloud, const std::string& name, bool sculptable = true)
      : server_(cloud, {.network = ownNetwork(),
                        .name = name,
                        .model = "a test's cloud",
                        .mm_per_unit = 2.5,
                        .sculptable = sculptable}),
        thread_([this] { server_.serve(stop_); }) {}
  ~Served() { end(); }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  ServedCounts end() {
    pause();
    return server_.counts();
  }
  /// Until goOn() it takes no edits and answers no requests.
  void pause() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  void goOn() {
    pause();
    stop_ = false;
    thread_ = std::jthread([this] { server_.serve(stop_); });
  }

 private:
  std::atomic<bool> stop_ = false;
  CloudServer server_;
  std::jthread thread_;
};

}  // namespace palpate
