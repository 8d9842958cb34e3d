// The proxy in double precision: over exact surfaces, two-faced sheets, edges, grooves and with friction.
#include "engine/contact/proxy_tracker.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/contact/contact_reference.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "tests/contact/sheet.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"

namespace palpate::proxy_test {

namespace {

// A god-object (Zilles and Salisbury 1995) is this field under a tracker with a small radius, moved in small steps.
class ExactSurface final : public SurfaceField {
 public:
  explicit ExactSurface(const AnalyticShape& shape) : shape_(shape) {}
  SurfaceSample surface(const DVec3& x, const DVec3&) const override {
    const SurfacePoint closest = shape_.closest(x);
    const double distance = shape_.signedDistance(x);
    const DVec3 away = x - closest.position;
    const bool on = glm::length(away) < 1e-9 * shape_.size();
    return {.defined = true,
            .distance = distance,
            .normal = on ? closest.normal : glm::normalize(distance < 0 ? -away : away),
            .neighbours = 100};
  }

 private:
  const AnalyticShape& shape_;
};

// Two faces at a right angle that meet in the line x = z = 0 and rise from it.
PointCloud groove() {
  PointCloud cloud;
  const double c = std::sqrt(0.5);
  for (int i = 0; i <= 60; ++i)
    for (int j = -30; j <= 30; ++j)
      for (const double side : {-1.0, 1.0}) {
        const double up = 0.5 * (i + 0.5) * c;
        cloud.positions.emplace_back(side * up, 0.5 * j, up);
        cloud.normals.emplace_back(-side * c, 0, c);
      }
  return cloud;
}

constexpr std::array<SurfaceKind, 3> kKinds{SurfaceKind::average, SurfaceKind::sphere, SurfaceKind::sharp};

}  // namespace

TEST_CASE("a hand deeper than a ridge is wide does not lose it while it rests, and not within a tick while it moves") {
  class Ridge final : public SurfaceField {  // along y, a cylinder with a radius of 1
   public:
    SurfaceSample surface(const DVec3& x, const DVec3&) const override {
      const double out = std::hypot(x.x, x.z);
      return {.defined = true, .distance = out - 1, .normal = {x.x / out, 0, x.z / out}, .neighbours = 100};
    }
  } ridge;
  ProxyTracker proxy(2);
  double most = 0;
  DVec3 normal(0, 0, 1);
  const auto follow = [&](const DVec3& hip) {
    proxy.follow(ridge, hip);
    if (proxy.touching()) most = std::max(most, std::acos(std::min(1.0, glm::dot(normal, proxy.surface().normal))));
    normal = proxy.surface().normal;
  };
  for (int i = 0; i <= 170; ++i) follow({0.05, 0, 3 - 0.02 * i});
  REQUIRE(proxy.touching());
  CHECK(most < 0.06);  // 0.02 of motion, and 0.005 at rest
  const DVec3 before = normal;
  for (int i = 0; i < 20; ++i) follow({0.05, 0, -0.4});
  CHECK(proxy.touching());
  CHECK(glm::dot(before, normal) > std::cos(0.11));
  // In the end it is beside the hand.
  for (int i = 0; i < 1000; ++i) follow({0.05, 0, -0.4});
  CHECK(proxy.touching());
  CHECK(glm::distance(proxy.proxy(), DVec3(0.05, 0, -0.4)) == near(1 - std::hypot(0.05, 0.4), 1e-3));
}

TEST_CASE("a surface that turns under a resting hand takes the proxy along in the same tick") {
  class Turning final : public SurfaceField {
   public:
    DVec3 normal{0, 0, 1};
    SurfaceSample surface(const DVec3& x, const DVec3&) const override {
      return {.defined = true, .distance = glm::dot(x, normal), .normal = normal, .neighbours = 100};
    }
  } plane;
  ProxyTracker proxy(2);
  proxy.follow(plane, {0, 0, 0.1});
  for (int i = 0; i <= 10; ++i) proxy.follow(plane, {0, 0, -0.05 * i});
  for (int i = 1; i <= 10; ++i) {
    plane.normal = {std::sin(0.05 * i), 0, std::cos(0.05 * i)};
    proxy.follow(plane, {0, 0, -0.5});
    CHECK(glm::distance(proxy.proxy(), DVec3(0, 0, -0.5) + 0.5 * plane.normal.z * plane.normal) < 1e-3);
  }
}

TEST_CASE("the proxy follows the exact god-object") {
  for (const std::string_view name : {"sphere", "torus", "bumpy-sphere"}) {
    CAPTURE(name);
    const Scene scene = makeScene(name, 50'000);
    const ContactReference sampled(scene.cloud, {.radius = scene.radius, .kind = SurfaceKind::sphere});
    const ExactSurface exact(*scene.shape);
    ProxyTracker proxy(scene.radius), godObject(0.2 * scene.radius);
    const auto path = wanderingPath(scene, 200, 0.4 * scene.radius, 5);
    std::size_t touched = 0, differ = 0;
    double worst = 0;
    DVec3 last = path.front();
    for (const DVec3& hip : path) {
      for (int part = 1; part <= 20; ++part) godObject.follow(exact, glm::mix(last, hip, part / 20.0));
      proxy.follow(sampled, hip);
      last = hip;
      touched += proxy.touching();
      differ += proxy.touching() != godObject.touching();
      if (proxy.touching() && godObject.touching())
        worst = std::max(worst, glm::distance(proxy.proxy(), godObject.proxy()));
    }
    CHECK(touched > 80);
    CHECK(differ <= 2);
    CHECK(worst < 0.01);  // mm
  }
}

TEST_CASE("a thin plate and a single sheet are felt from both sides, at the face that the HIP came from") {
  for (const SurfaceKind kind : kKinds)
    for (const double thickness : {0.0, 0.3, 1.0, 3.0}) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(thickness);
      const PointCloud cloud = sheet(thickness);
      for (const double up : {1.0, -1.0}) {
        ContactReference touch(cloud, {.radius = kSheetRadius, .kind = kind});
        const double face = up > 0 ? 0 : -thickness;
        for (double height = 5; height > 0.05; height -= 0.1)
          REQUIRE_FALSE(touch.query({.hip = {1.3, 0.2, face + up * height}}, 0).touching);
        for (double depth = 0.05; depth < 6; depth += 0.1) {
          const Contact contact = touch.query({.hip = {1.3 + 0.2 * depth, 0.2, face - up * depth}}, 0);
          REQUIRE(contact.touching);
          CHECK(std::abs(contact.proxy.z - face) < 1e-6);
          CHECK(contact.normal.z * up > 0.999);
        }
        CHECK_FALSE(touch.query({.hip = {1.3, 0.2, face + 0.1 * up}}, 0).touching);
      }
    }
}

TEST_CASE("the proxy never passes through a plate, at up to 1 m/s and 3.3 N" * kMoreInFull) {
  constexpr double kDeepest = 3.3 / 0.8;  // mm, at 0.8 N/mm
  struct Case {
    double thickness, radius;
    bool localRadius;
    int pushes;
  };
  const int pushes = byTier(500, 5'000), slowPushes = byTier(50, 500);
  for (const Case& plate :
       {Case{0.5, kSheetRadius, false, pushes}, Case{2.1 * kSheetRadius, kSheetRadius, false, pushes},
        Case{0.5, 3 * kSheetRadius, true, slowPushes}}) {
    CAPTURE(plate.thickness);
    CAPTURE(plate.radius);
    const PointCloud cloud = sheet(plate.thickness);
    CpuTouch touch(
        cloud, {.radius = plate.radius, .surface = SurfaceKind::sharp, .localRadius = plate.localRadius, .threads = 1});
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::size_t through = 0;
    for (int push = 0; push < plate.pushes; ++push) {
      const double step = 0.525 + 0.475 * unit(random);  // mm in 1 ms
      const DVec3 aim(12 * unit(random), 12 * unit(random), 0);
      const DVec3 heading = glm::normalize(DVec3{unit(random), unit(random), -0.6});
      bool touched = false;
      for (double along = -(plate.radius + 1) / -heading.z; - heading.z * along < kDeepest; along += step) {
        const Contact contact = touch.query({.hip = aim + along * heading}, 0);
        if (-heading.z * along > 1e-6) through += !contact.touching || contact.proxy.z < -0.1;
        touched = touched || contact.touching;
      }
      through += !touched;
      touch.query({.hip = {0, 0, 500}}, 0);
    }
    CHECK(through == 0);
    touch.finish();
  }
}

TEST_CASE("a HIP that starts behind a sheet, or was released inside, is not caught on its way out") {
  const PointCloud cloud = sheet();
  ContactReference touch(cloud, {.radius = kSheetRadius});
  for (double z = -1.5; z < 3; z += 0.1) CHECK_FALSE(touch.query({.hip = {0, 0, z}}, 0).touching);
  CHECK(touch.query({.hip = {0, 0, -0.5}}, 0).touching);
}

TEST_CASE("sliding over an edge rotates the force no faster than the HIP moves") {
  const Scene scene = makeScene("cube", 200'000);
  for (const double skew : {0.0, 0.4}) {
    CpuTouch touch(scene.cloud, {.radius = scene.radius, .surface = SurfaceKind::sharp, .threads = 1});
    constexpr double kStep = 0.05, kDepth = 1;  // mm in 1 ms; 1 mm below top and side
    touch.query({.hip = {40, 0, 53}}, 0);
    DVec3 last(0);
    double worst = 0;
    std::size_t touched = 0, ticks = 0;
    for (double along = 0; along < 19; along += kStep) {
      const double over = std::max(0.0, along - 9);
      const DVec3 hip(40 + along - over, skew * along, 50 - kDepth - over);
      const Contact contact = touch.query({.hip = hip}, 0);
      const DVec3 spring = contact.proxy - hip;
      if (ticks++ > 5) worst = std::max(worst, glm::distance(spring, last) / glm::length(last));
      touched += contact.touching;
      last = spring;
    }
    CHECK(touched == ticks);
    CHECK(worst < 0.1);
    CHECK(last.z > 10.9);  // still held by the edge of the top
    touch.finish();
  }
}

TEST_CASE("the proxy settles at the bottom of a groove and leaves it with the HIP") {
  const PointCloud cloud = groove();
  for (const SurfaceKind kind : kKinds) {
    CAPTURE(static_cast<int>(kind));
    ContactReference touch(cloud, {.radius = kSheetRadius, .kind = kind});
    DVec3 last(0);
    double jitter = 0;
    const auto at = [&](double x, double z) { return touch.query({.hip = {x, 0.1, z}}, 0); };
    CHECK_FALSE(at(-4, 7).touching);
    for (double x = -4; x <= 4; x += 0.02) {
      const double z = -0.5 + 0.4 * std::abs(x);
      const Contact contact = at(x, z);
      REQUIRE(contact.touching);
      CHECK(contact.proxy.z > std::abs(contact.proxy.x) - 0.6 * kSheetRadius);
      const DVec3 spring = contact.proxy - DVec3(x, 0.1, z);
      if (x > -3.9) jitter = std::max(jitter, glm::distance(spring, last) / glm::length(last));
      last = spring;
    }
    CHECK(jitter < 0.25);
    CHECK_FALSE(at(4, 5).touching);
    CHECK_FALSE(at(0, 2).touching);
  }
}

TEST_CASE("friction holds the proxy within its cone, then drags it along the border of the cone") {
  const PointCloud cloud = sheet();
  constexpr double kFriction = 0.4, kDepth = 1.5;
  for (const SurfaceKind kind : kKinds) {
    ContactReference touch(cloud, {.radius = kSheetRadius, .kind = kind}, kFriction);
    touch.query({.hip = {0, 0, 1}}, 0);
    touch.query({.hip = {0, 0, -kDepth}}, 0);
    const double holds = kFriction * static_cast<double>(shared::kStaticFriction) * kDepth;
    for (double x = 0; x < 0.98 * holds; x += 0.01)
      CHECK(glm::length(touch.query({.hip = {x, 0, -kDepth}}, 0).proxy) < 1e-6);
    for (double x = 1.05 * holds; x < 8; x += 0.05) {
      const DVec3 hip(x, 0, -kDepth), spring = touch.query({.hip = hip}, 0).proxy - hip;
      CHECK(-spring.x / spring.z == near(kFriction, 0.01));
    }
    const DVec3 rests = touch.query({.hip = {8, 0, -kDepth}}, 0).proxy;
    for (int tick = 0; tick < 100; ++tick) CHECK(touch.query({.hip = {8, 0, -kDepth}}, 0).proxy == rests);
  }
}

TEST_CASE("a resting proxy moves with the points below it, and is released when they leave") {
  PointCloud cloud = sheet();
  class Moving final : public SurfaceField {
   public:
    explicit Moving(const PointCloud& cloud) : cloud_(cloud) {}
    SurfaceSample surface(const DVec3& x, const DVec3& facing) const override {
      return surfaceOf({.radius = kSheetRadius, .kind = SurfaceKind::sphere}, facing, [&](double radius, auto&& visit) {
        for (std::size_t i = 0; i < cloud_.size(); ++i) {
          const DVec3 offset = DVec3(cloud_.positions[i]) - x;
          if (glm::dot(offset, offset) < radius * radius) visit(offset, cloud_.normals[i]);
        }
      });
    }

   private:
    const PointCloud& cloud_;
  };
  const Moving field(cloud);
  ProxyTracker tracker(kSheetRadius);
  tracker.follow(field, {0, 0, 1});
  tracker.follow(field, {0, 0, -3});
  for (int tick = 1; tick <= 20; ++tick) {
    for (Vec3& position : cloud.positions) position.z = -0.1f * static_cast<float>(tick);
    tracker.follow(field, {0, 0, -3});
    REQUIRE(tracker.touching());
    CHECK(tracker.proxy().z == within(-0.1 * tick, 1e-6));
  }
  for (Vec3& position : cloud.positions) position.z = -50;
  tracker.follow(field, {0, 0, -3});
  CHECK_FALSE(tracker.touching());
  CHECK(tracker.proxy() == DVec3(0, 0, -3));
}

namespace {

/// A plane that rises with the time of the tick and counts its queries.
class RisingPlane final : public SurfaceField {
 public:
  explicit RisingPlane(double speed) : speed_(speed) {}
  void moveTo(double time_s) { height_ = speed_ * time_s, looks = 0; }
  SurfaceSample surface(const DVec3& x, const DVec3&) const override {
    ++looks;
    const double distance = x.z - height_;
    if (std::abs(distance) > 1) return {};
    return {.defined = true, .distance = distance, .normal = {0, 0, 1}, .neighbours = 9};
  }
  DVec3 velocity(const DVec3&, const DVec3&) const override { return {0, 0, speed_}; }

  double height() const { return height_; }
  mutable int looks = 0;

 private:
  double speed_, height_ = 0;
};

}  // namespace

TEST_CASE("a hand that moves along with a fast surface above it does not touch it") {
  // Three support radii per tick: the last position of the hand is far behind the plane at this tick.
  RisingPlane plane(3'000);
  ProxyTracker tracker(1);
  for (int i = 0; i < 20; ++i) {
    const double time_s = 1e-3 * i;
    plane.moveTo(time_s);
    tracker.follow(plane, {0.1, 0, plane.height() + 0.3}, time_s, {.true_s = time_s});
    CHECK_FALSE(tracker.touching());
    CHECK(plane.looks == 1);
  }
  // Then the hand stops, and the plane carries the proxy along.
  const double hip = plane.height() + 0.3;
  for (int i = 20; i < 24; ++i) {
    plane.moveTo(1e-3 * i);
    tracker.follow(plane, {0.1, 0, hip}, 1e-3 * i, {.true_s = 1e-3 * i});
    CHECK(tracker.touching());
    CHECK(tracker.proxy().z == within(plane.height(), 1e-6));
  }
}

}  // namespace palpate::proxy_test
