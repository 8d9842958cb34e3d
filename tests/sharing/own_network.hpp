// A network without other test programs, and sessions served on it for the duration of a test.
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <concepts>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "engine/core/clock.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "tests/own_domain.hpp"

namespace palpate {

inline NetworkConfig ownNetwork() { return {.domain = ownDomain()}; }

/// Points around a ring, each a little above the one before.
inline PointCloud ring(std::size_t points) {
  PointCloud cloud;
  for (std::size_t i = 0; i < points; ++i) {
    const double t = static_cast<double>(i) * 0.7;
    cloud.positions.emplace_back(std::sin(t) * 40, std::cos(t) * 40, 0.001 * static_cast<double>(i));
    cloud.normals.push_back(glm::normalize(Vec3(std::sin(t), std::cos(t), 0)));
  }
  return cloud;
}

/// Whether it is true, or becomes so within that time.
inline bool within(double seconds, const std::function<bool()>& holds) {
  for (const Stopwatch since; since.elapsed_s() < seconds; std::this_thread::sleep_for(std::chrono::milliseconds(2)))
    if (holds()) return true;
  return holds();
}

class Served {
 public:
  Served(const PointCloud& cloud, const std::convertible_to<std::string> auto& name, bool sculptable = true)
      : Served(cloud, CloudServer::Parts{.name = name, .sculptable = sculptable}) {}
  Served(const PointCloud& cloud, CloudServer::Parts parts)
      : server_(cloud, here(std::move(parts))), thread_([this] { server_.serve(stop_); }) {}
  ~Served() { end(); }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  ServedCounts end() {
    pause();
    return server_.counts();
  }
  /// Current points, by id; after end().
  std::span<const PointState> points() const { return server_.points(); }
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
  static CloudServer::Parts here(CloudServer::Parts parts) {
    parts.network = ownNetwork();
    parts.model = "a test's cloud";
    parts.mm_per_unit = 2.5;
    return parts;
  }
  std::atomic<bool> stop_ = false;
  CloudServer server_;
  std::jthread thread_;
};

}  // namespace palpate
