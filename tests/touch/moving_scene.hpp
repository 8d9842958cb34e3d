// A sphere that moves under hands, for each back end: compared with the exact depth at each tick's time.
#pragma once

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
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
    touch.prepare();
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

/// In real time, on a sphere of radius 50 whose next frame, which rises to the stylus, is made only when it is
/// released.
inline void checkNoTickWaits(auto& touch, HeldSource& source) {
  CloudFrame frame;
  CHECK(touch.frames()->take(frame));
  for (int i = 1; i <= 20; ++i) {
    const Contact contact = touch.query({.time_s = kTick_s * i, .hip = {0, 0, 50.5}}, 1e6);
    CHECK(contact.fresh);
    CHECK_FALSE(contact.touching);
    touch.prepare();
    CHECK_FALSE(touch.frames()->take(frame));
    if (i == 1) source.waitUntilAsked();
  }
  source.letGo();
  touch.finish();
  CHECK(touch.frames()->take(frame));
  CHECK(frame.time_s == kTick_s);
  CHECK(touch.query({.time_s = 0.021, .hip = {0, 0, 50.5}}, 1e6).touching);
}

/// Makes a back end from a cloud, a source and a coefficient of friction.
using MakeTouch =
    std::function<std::unique_ptr<TouchBackend>(const Scene& scene, CloudSource& source, double friction)>;

/// Frames up to 20 ms old are felt at the surface's current position, and with its velocity.
inline void checkOldFrames(const MakeTouch& make, int ticks = 600) {
  const Scene scene = makeScene("sphere", 20'000);
  const RigidMotion motion = oscillation(2, 2);
  SlowSource source(scene.cloud, motion, 0.02);
  const auto touch = make(scene, source, 0);
  const DVec3 hip(0, 0, 50.2);
  const auto contacts = feelAtRest(*touch, hip, ticks);
  const DepthError error = depthError(contacts, hip, MovingShape(*scene.shape, motion), 0.2);
  CHECK(static_cast<int>(error.inside) > ticks / 3);
  CHECK(error.rms < 0.03);
  CHECK(error.wronglyFree == 0);
  CHECK(error.wronglyTouching == 0);
  for (std::size_t i = 100; i < contacts.size(); i += 20) {
    const RigidPose pose = motion.poseAt(kTick_s * static_cast<double>(i));
    if (contacts[i].touching) CHECK(glm::distance(contacts[i].velocity, pose.velocity) < 2);
  }
}

/// After the last frame the surface continues for a while, then stands still.
inline void checkStoppedFrames(const MakeTouch& make) {
  const Scene scene = makeScene("plane", 10'000);
  const RigidMotion motion{.kind = MotionKind::drift, .axis = {0, 0, -1}, .speed = 10};
  SlowSource source(scene.cloud, motion, 1e6);
  const auto touch = make(scene, source, 0);
  touch->query({.time_s = 0, .hip = {0, 0, 1}}, 0);
  touch->prepare();
  const double until_s = kMaxPointsAge_s;
  for (int i = 1; i < 200; ++i) {
    const double time_s = kTick_s * i;
    const Contact contact = touch->query({.time_s = time_s, .hip = {0, 0, -2}}, 0);
    touch->prepare();
    CHECK(contact.touching);
    if (i > 2) CHECK(std::abs(contact.proxy.z + 10 * std::min(time_s, until_s)) < 0.02);
  }
}

/// Friction depends on the relative slide: a hand at rest on a plane that moves below it is dragged as far as the cone
/// allows, and a hand that moves along is not dragged.
inline void checkCarriedProxy(const MakeTouch& make) {
  const Scene scene = makeScene("plane", 20'000);
  constexpr double kSpeed = 100, kFriction = 0.5, kDepth = 1;
  MovingCloud source(scene.cloud, {.kind = MotionKind::drift, .axis = {1, 0, 0}, .speed = kSpeed});
  for (const double handSpeed : {0.0, kSpeed, -kSpeed}) {
    CAPTURE(handSpeed);
    const auto touch = make(scene, source, kFriction);
    Contact contact;
    DVec3 hip;
    for (int i = 0; i < 60; ++i) {
      hip = {handSpeed * kTick_s * i, 0.3, std::max(1 - 0.1 * i, -kDepth)};
      contact = touch->query({.time_s = kTick_s * i, .hip = hip}, 0);
      touch->prepare();
    }
    REQUIRE(contact.touching);
    const DVec3 drag = contact.proxy - hip;
    CHECK(std::abs(drag.z - kDepth) < 0.01);
    CHECK(std::abs(drag.y) < 0.01);
    if (handSpeed == kSpeed)
      CHECK(std::abs(drag.x) < 0.02);
    else
      CHECK(std::abs(drag.x - kFriction * kDepth) < 0.05);
    CHECK(glm::distance(contact.velocity, DVec3(kSpeed, 0, 0)) < 1e-3);
  }
}

/// A sheet that approaches at half a metre per second and carries the stylus along for 20 mm never lets it through; a
/// stylus that it leaves behind is free at once.
inline void checkFastSheet(const MakeTouch& make) {
  const Scene scene = makeScene("plane", 30'000);
  constexpr double kSpeed = 500;
  for (const double sign : {1.0, -1.0}) {
    CAPTURE(sign);
    MovingCloud source(scene.cloud, {.kind = MotionKind::drift, .axis = {0, 0, sign}, .speed = kSpeed});
    const auto touch = make(scene, source, 0);
    const double start = 5.3;
    int touched = 0, through = 0, wrong = 0;
    for (int i = 0; i < 40; ++i) {
      const double surface = sign * kSpeed * kTick_s * i, hip = sign * start;  // the sheet has two faces
      const Contact contact = touch->query({.time_s = kTick_s * i, .hip = {0.2, 0.1, hip}}, 0);
      touch->prepare();
      const double depth = sign * (surface - hip);
      if (depth > 0.02) {
        ++touched;
        through += !contact.touching || sign * (contact.proxy.z - surface) < -0.05 ||
                   std::abs(contact.proxy.z - surface) > 0.05;
      } else if (depth < -0.02) {
        wrong += contact.touching;
      }
    }
    CHECK(touched > 25);
    CHECK(through == 0);
    CHECK(wrong == 0);
  }
}

/// An object that disappears between two frames is not felt from that tick on; an object that reappears is felt again
/// by a stylus that approaches from outside.
inline void checkLeaving(const MakeTouch& make) {
  const Scene scene = makeScene("sphere", 5'000);
  const double gone_s = 0.0205, back_s = 0.0405;
  for (const bool namesIds : {true, false}) {
    PartialSource source(
        scene.cloud, [&](double time_s, std::uint32_t) { return time_s < gone_s || time_s > back_s; }, namesIds);
    const auto touch = make(scene, source, 0.3);
    for (int i = 0; i < 70; ++i) {
      const double time_s = kTick_s * i, z = i < 50 ? std::max(51 - 0.2 * i, 49.0) : 51 - 0.2 * (i - 50);
      const Contact contact = touch->query({.time_s = time_s, .hip = {0, 0, z}}, 0);
      touch->prepare();
      CAPTURE(i);
      CHECK(contact.valid);
      if (time_s > gone_s && time_s < back_s) {
        CHECK_FALSE(contact.touching);
        CHECK(contact.proxy == DVec3(0, 0, z));
        CHECK(contact.neighbours == 0);
      }
      if (i == 19 || i == 69) CHECK(contact.touching);
    }
    touch->finish();
  }
}

/// A frame with holes is felt as the cloud of its points, bit by bit, and read back as it was shown.
inline void checkHoles(const MakeTouch& make) {
  const Scene scene = makeScene("torus", 4'000);
  const auto shown = [](double, std::uint32_t id) { return id % 3 != 0 && id > 100; };
  PartialSource source(scene.cloud, shown);
  CloudFrame part;
  source.makeFrame(0, part);
  Scene rest{.shape = makeShape("torus", 100.0, DVec3(0)), .spacing = scene.spacing, .radius = scene.radius};
  rest.cloud.positions = part.positions;
  rest.cloud.normals = part.normals;
  MovingCloud still(rest.cloud, {});
  const auto some = make(scene, source, 0), alone = make(rest, still, 0);
  std::size_t touched = 0, other = 0;
  for (const DVec3& hip : wanderingPath(scene, 80, 0.5 * scene.radius, 3)) {
    const Contact a = some->query({.hip = hip}, 0), b = alone->query({.hip = hip}, 0);
    touched += a.touching;
    other += glm::distance(a.proxy, b.proxy) > 1e-4 || a.touching != b.touching || a.neighbours != b.neighbours;
  }
  CHECK(touched > 5);
  CHECK(other == 0);
  some->finish();
  CloudFrame seen;
  CHECK(some->frames()->take(seen));
  CHECK(seen.positions == part.positions);
  CHECK(seen.ids == part.ids);
  CHECK(seen.colors == part.colors);
  PointCloud end = scene.cloud;
  CHECK(some->readBack(end) == part.size());
  CHECK(end.positions == part.positions);
  CHECK(end.colors.at(1)[2] == 7);
}

}  // namespace palpate
