// A sphere that moves under hands, for each back end: what is felt is held against the exact depth at each tick's time.
#pragma once

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/motion/moving_cloud.hpp"
#include "engine/motion/moving_shape.hpp"
#include "tests/scenes.hpp"

namespace palpate {

inline constexpr double kTick_s = 1e-3;

/// To and fro along z by 2 (mm, with a sphere of radius 50), ten times in a second: 126 mm/s at the most.
inline RigidMotion oscillation(double amplitude = 2, double frequency_Hz = 10) {
  return {.amplitude = amplitude, .frequency_Hz = frequency_Hz};
}

/// Says other things than its points do from some time on.
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

/// Makes no frame after the first until it is let go.
class HeldSource final : public CloudSource {
 public:
  HeldSource(const PointCloud& cloud, const RigidMotion& motion) : moving_(cloud, motion) {}
  std::size_t size() const override { return moving_.size(); }
  void makeFrame(double time_s, CloudFrame& frame) override {
    if (begun_) held_.wait(true);
    begun_ = true;
    moving_.makeFrame(time_s, frame);
  }
  void letGo() {
    held_ = false;
    held_.notify_all();
  }

 private:
  MovingCloud moving_;
  bool begun_ = false;
  std::atomic<bool> held_ = true;
};

/// A HIP at rest, asked for so many ticks in virtual time.
inline std::vector<Contact> feelAtRest(TouchBackend& touch, const DVec3& hip, int ticks) {
  std::vector<Contact> contacts;
  for (int i = 0; i < ticks; ++i) {
    contacts.push_back(touch.query({.time_s = kTick_s * i, .hip = hip}, 0));
    touch.prepare();
  }
  return contacts;
}

struct DepthError {
  double rms = 0;  ///< of the exact depth's own root mean square
  int inside = 0, wronglyFree = 0, wronglyTouching = 0;
};
/// How far HIP to proxy is, against the exact depth at each tick. Within `grey` of the surface both answers are right.
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

/// Against the clock, on a sphere of radius 50 whose next frame, which rises to the stylus, is made only when it is let go.
inline void checkNoTickWaits(auto& touch, HeldSource& source) {
  CloudFrame frame;
  CHECK(touch.takeFrame(frame));
  for (int i = 1; i <= 20; ++i) {
    const Contact contact = touch.query({.time_s = kTick_s * i, .hip = {0, 0, 50.5}}, 1e6);
    CHECK(contact.fresh);
    CHECK_FALSE(contact.touching);
    touch.prepare();
    CHECK_FALSE(touch.takeFrame(frame));
  }
  source.letGo();
  touch.finish();
  CHECK(touch.takeFrame(frame));
  CHECK(frame.time_s == kTick_s);
  CHECK(touch.query({.time_s = 0.021, .hip = {0, 0, 50.5}}, 1e6).touching);
}

}  // namespace palpate
