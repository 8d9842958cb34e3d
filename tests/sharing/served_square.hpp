// A square cloud served to clients that receive only the points around their hands.
#pragma once

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate {

/// A square of 200 x 200 points, one apart.
inline PointCloud square(float height = 0) {
  PointCloud cloud;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      cloud.positions.emplace_back(x, y, height);
      cloud.normals.emplace_back(0, 0, 1);
    }
  return cloud;
}

class ServedSquare {
 public:
  explicit ServedSquare(const PointCloud& cloud, const std::string& name, ServedMotion motion = {},
                        const std::filesystem::path& journal = {}, std::function<Restarts()> restarts = {})
      : server_(cloud, {.network = ownNetwork(),
                        .name = name,
                        .sculptable = !motion,
                        .journal = journal,
                        .motion = std::move(motion),
                        .restarts = std::move(restarts)}),
        thread_([this] { server_.serve(stop_); }) {}
  ~ServedSquare() { end(); }
  ServedCounts end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    return server_.counts();
  }
  /// Valid after end().
  std::span<const PointState> points() const { return server_.points(); }

 private:
  std::atomic<bool> stop_ = false;
  CloudServer server_;
  std::jthread thread_;
};

inline bool within(double seconds, const std::function<bool()>& holds) {
  for (const double end_s = steadyNow_s() + seconds; steadyNow_s() < end_s;) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return holds();
}

inline HandReaches handAt(const DVec3& hip) {
  HandReaches hands{.time_s = steadyNow_s(), .steady_s = steadyNow_s(), .count = 1};
  hands.hands[0] = {.low = hip - 3.0, .high = hip + 3.0, .hip = hip, .proxy = hip};
  return hands;
}

/// Number of points of the newest frame within 3 of the hand.
inline std::size_t around(BrickSource& source, const DVec3& hip, CloudFrame& frame) {
  source.makeFrame(steadyNow_s(), frame);
  std::size_t found = 0;
  for (const Vec3& position : frame.positions) found += glm::distance(DVec3(position), hip) < 3;
  return found;
}

inline JoinedCloud joinNear(const std::string& name, Log* log = nullptr) {
  return joinCloud(name, {.network = ownNetwork(), .partial = true, .log = log});
}

}  // namespace palpate
