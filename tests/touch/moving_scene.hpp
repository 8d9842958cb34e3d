// Sources of moving points, and what a hand at rest feels of them, compared with the exact depth at each tick's time.
#pragma once

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/core/error.hpp"
#include "engine/motion/moving_cloud.hpp"
#include "engine/touch/touch_backend.hpp"
#include "tests/moving_shape.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/tick.hpp"

namespace palpate {

/// Oscillates along z by 2 (mm, with a sphere of radius 50) at 10 Hz: at most 126 mm/s.
inline RigidMotion oscillation(double amplitude = 2, double frequency_Hz = 10) {
  return {.amplitude = amplitude, .frequency_Hz = frequency_Hz};
}

/// Reports invalid data from some time on.
class BrokenSource final : public CloudSource {
 public:
  enum class Fault { notANumber, infiniteNormal, tooFew };
  BrokenSource(const PointCloud& cloud, Fault fault, double from_s)
      : whole_(cloud, {}), fault_(fault), from_s_(from_s) {}
  std::size_t size() const override { return whole_.size(); }
  void makeFrame(double time_s, CloudFrame& frame) override {
    whole_.makeFrame(time_s, frame);
    if (time_s < from_s_) return;
    if (fault_ == Fault::notANumber) frame.positions.back().y = std::numeric_limits<float>::quiet_NaN();
    if (fault_ == Fault::infiniteNormal) frame.normals.front().x = std::numeric_limits<float>::infinity();
    if (fault_ == Fault::tooFew) frame.positions.pop_back();
  }

 private:
  MovingCloud whole_;
  Fault fault_;
  double from_s_;
};

/// Makes no frame after the first until it is released, and has no velocities.
class HeldSource final : public CloudSource {
 public:
  HeldSource(const PointCloud& cloud, const RigidMotion& motion) : moving_(cloud, motion) {}
  std::size_t size() const override { return moving_.size(); }
  void makeFrame(double time_s, CloudFrame& frame) override {
    if (begun_) {
      asked_ = true;
      asked_.notify_all();
      held_.wait(true);
    }
    begun_ = true;
    moving_.makeFrame(time_s, frame);
    frame.velocities.clear();
  }
  /// Waits until a thread waits for the second frame.
  void waitUntilAsked() const { asked_.wait(false); }
  void letGo() {
    held_ = false;
    held_.notify_all();
  }

 private:
  MovingCloud moving_;
  bool begun_ = false;
  std::atomic<bool> asked_ = false, held_ = true;
};

/// Makes a frame only at the beginning of each period, as a camera does, and repeats it until the next.
class SlowSource final : public CloudSource {
 public:
  SlowSource(const PointCloud& cloud, const RigidMotion& motion, double period_s)
      : moving_(cloud, motion), period_s_(period_s) {}
  std::size_t size() const override { return moving_.size(); }
  void makeFrame(double time_s, CloudFrame& frame) override {
    moving_.makeFrame(period_s_ * std::floor(time_s / period_s_ + 1e-9), frame);
  }

 private:
  MovingCloud moving_;
  double period_s_;
};

/// Contains only the points that `shown` selects, at each time, each with its id in a file of more points.
class PartialSource final : public CloudSource {
 public:
  using Shown = std::function<bool(double time_s, std::uint32_t id)>;
  PartialSource(const PointCloud& cloud, Shown shown, bool namesIds = true)
      : whole_(cloud, {}), shown_(std::move(shown)), namesIds_(namesIds) {}
  std::size_t size() const override { return whole_.size(); }
  bool keepsPoints() const override { return namesIds_; }
  void makeFrame(double time_s, CloudFrame& frame) override {
    CloudFrame all;
    whole_.makeFrame(time_s, all);
    frame = {.time_s = time_s};
    for (std::uint32_t id = 0; id < all.size(); ++id) {
      if (!shown_(time_s, id)) continue;
      frame.positions.push_back(all.positions[id]);
      frame.normals.push_back(all.normals[id]);
      frame.colors.push_back({static_cast<std::uint8_t>(id), static_cast<std::uint8_t>(id >> 8), 7});
      if (namesIds_) frame.ids.push_back(id);
    }
  }

 private:
  MovingCloud whole_;
  Shown shown_;
  bool namesIds_;
};

/// A HIP at rest, queried for `ticks` ticks in virtual time.
inline std::vector<Contact> feelAtRest(TouchBackend& touch, const DVec3& hip, int ticks) {
  std::vector<Contact> contacts;
  for (int i = 0; i < ticks; ++i) {
    contacts.push_back(touch.query({.time_s = kTick_s * i, .hip = hip}, 0));
  }
  return contacts;
}

struct DepthError {
  double rms = 0;  ///< relative to the root mean square of the exact depth
  int inside = 0, wronglyFree = 0, wronglyTouching = 0;
};
/// Compares the distance from HIP to proxy with the exact depth at each tick. Within `grey` of the surface both answers
/// are right.
inline DepthError depthError(std::span<const Contact> contacts, const DVec3& hip, const MovingShape& truth,
                             double grey) {
  DepthError error;
  double squares = 0, depths = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double depth = -truth.signedDistance(hip, kTick_s * static_cast<double>(i));
    const double felt = contacts[i].touching ? glm::distance(contacts[i].proxy, hip) : 0;
    if (depth > grey && !contacts[i].touching) ++error.wronglyFree;
    if (depth < -grey && contacts[i].touching) ++error.wronglyTouching;
    if (depth <= grey) continue;
    ++error.inside;
    squares += (felt - depth) * (felt - depth);
    depths += depth * depth;
  }
  error.rms = std::sqrt(squares / std::max(depths, 1e-300));
  return error;
}

inline bool sameAnswer(const Contact& a, const Contact& b) {
  return a.proxy == b.proxy && a.normal == b.normal && a.touching == b.touching && a.valid == b.valid &&
         a.fresh == b.fresh && a.neighbours == b.neighbours;
}

}  // namespace palpate
