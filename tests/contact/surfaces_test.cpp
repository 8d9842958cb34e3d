// The three kinds of surface on shapes with known geometry.
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <string_view>
#include <vector>

#include "engine/cloud/counter_random.hpp"
#include "engine/contact/contact_reference.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"

namespace palpate::surfaces_test {

namespace {

struct Accuracy {
  std::size_t undefined = 0;
  double bias = 0, rms = 0;  // of the distance to the true surface, model units
  double p95_deg = 0;        // of the angle to the true normal
};

// Distance of a position on a cube from the nearest edge.
double fromEdge(const DVec3& x) {
  std::array<double, 3> sides{std::abs(x.x), std::abs(x.y), std::abs(x.z)};
  std::ranges::sort(sides);
  return sides[2] - sides[1];
}

// Projects positions near the points of `clean` onto the surface of scene.cloud. `apart` (model units): on a cube, only
// uses positions at least this far from the edges and within a support radius of them.
Accuracy accuracyOf(const Scene& scene, const PointCloud& clean, SurfaceKind kind, double apart = 0) {
  const ContactReference reference(scene.cloud, {.radius = scene.radius, .kind = kind});
  Accuracy accuracy;
  std::vector<double> angles;
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i<clean.size(); i += apart> 0 ? 17 : 197) {
    const double phase = static_cast<double>(i);
    const DVec3 start(clean.positions[i]);
    if (apart > 0 && (fromEdge(start) < apart || fromEdge(start) > scene.radius)) continue;
    DVec3 x = start + 0.1 * scene.radius * DVec3(std::sin(phase), std::cos(1.3 * phase), std::sin(2.7 * phase));
    SurfaceSample sample = reference.surface(x);
    for (int step = 0; step < 20 && sample.defined; ++step) {
      x -= sample.distance * sample.normal;
      sample = reference.surface(x);
    }
    if (!sample.defined) {
      ++accuracy.undefined;
      continue;
    }
    const double distance = scene.shape->signedDistance(x);
    const SurfacePoint truth = scene.shape->closest(x - 1e-3 * scene.radius * sample.normal);
    angles.push_back(angleBetween_deg(sample.normal, truth.normal));
    sum += distance;
    squares += distance * distance;
  }
  REQUIRE(angles.size() > 300);
  std::ranges::sort(angles);
  accuracy.p95_deg = angles[angles.size() * 95 / 100];
  accuracy.bias = sum / static_cast<double>(angles.size());
  accuracy.rms = std::sqrt(squares / static_cast<double>(angles.size()));
  return accuracy;
}

constexpr std::size_t kPoints = 200'000;

// The points of two even grids on z = 0: a spacing of 1 where x < 0, of sqrt(10) elsewhere.
PointCloud twoDensities() {
  PointCloud cloud;
  const auto add = [&](double x, double y) {
    cloud.positions.emplace_back(x, y, 0);
    cloud.normals.emplace_back(0, 0, 1);
  };
  for (int i = -60; i < 0; ++i)
    for (int j = -40; j <= 40; ++j) add(i, j);
  const double wide = std::sqrt(10.0);
  for (int i = 0; i <= 19; ++i)
    for (int j = -12; j <= 12; ++j) add(wide * (i + 0.5), wide * j);
  return cloud;
}

}  // namespace

TEST_CASE("sphere and sharp surfaces fit round shapes without bias; the average surface has its theoretical bias") {
  for (const std::string_view name : {"sphere", "torus", "bumpy-sphere"}) {
    CAPTURE(name);
    const Scene scene = makeScene(name, kPoints);
    for (const SurfaceKind kind : {SurfaceKind::sphere, SurfaceKind::sharp}) {
      const Accuracy accuracy = accuracyOf(scene, scene.cloud, kind);
      CHECK(accuracy.undefined == 0);
      CHECK(accuracy.p95_deg < 0.1);
      CHECK(accuracy.rms < 1e-4);  // mm; 2e-3 would do
    }
    const Accuracy average = accuracyOf(scene, scene.cloud, SurfaceKind::average);
    CHECK(average.p95_deg < 0.4);
    if (name == "sphere") CHECK(-average.bias == near(averageSurfaceBias(scene.radius, 50), 0.1));
  }
}

TEST_CASE("sharp surfaces keep the edges of a cube, which the others round off") {
  const Scene scene = makeScene("cube", kPoints);
  const double apart = 1.5 * scene.spacing;
  const Accuracy sharp = accuracyOf(scene, scene.cloud, SurfaceKind::sharp, apart);
  CHECK(sharp.p95_deg < 0.1);
  CHECK(sharp.rms < 1e-4);
  CHECK(accuracyOf(scene, scene.cloud, SurfaceKind::average, apart).p95_deg > 5);
  CHECK(accuracyOf(scene, scene.cloud, SurfaceKind::sphere, apart).p95_deg > 5);
}

TEST_CASE("noise of a quarter spacing hardly rotates normals and shifts the surface by less than its mean" *
          kMoreInFull) {
  for (const std::string_view name :
       byTier<std::vector<std::string_view>>({"torus"}, {"sphere", "torus", "bumpy-sphere"})) {
    CAPTURE(name);
    const Scene clean = makeScene(name, kPoints);
    Scene noisy = makeScene(name, kPoints, DVec3(0), 0.25 * clean.spacing);
    noisy.radius = clean.radius;
    for (const auto& [kindName, kind] : kSurfaceKinds) {
      CAPTURE(kindName);
      const Accuracy accuracy = accuracyOf(noisy, clean.cloud, kind);
      CHECK(accuracy.undefined == 0);
      CHECK(accuracy.p95_deg < 0.6);
      CHECK(accuracy.rms < 0.03);
    }
  }
}

TEST_CASE("a surface ends within half a support radius of its last points") {
  const Scene scene = makeScene("plane", 20'000);
  for (const auto& [name, kind] : kSurfaceKinds) {
    CAPTURE(name);
    const ContactReference reference(scene.cloud, {.radius = scene.radius, .kind = kind});
    for (double y = -30; y < 30; y += 3.1) {
      CHECK(reference.surface({50 - 0.3 * scene.radius, y, 0.05}).defined);
      CHECK(reference.surface({50, y, 0.05}).defined);
      CHECK_FALSE(reference.surface({50 + 0.5 * scene.radius, y, 0.05}).defined);
      CHECK_FALSE(reference.surface({50 + 0.5 * scene.radius, y, -0.3 * scene.radius}).defined);
    }
  }
}

TEST_CASE("the support radius follows the local spacing, and the surface stays smooth where it changes") {
  const PointCloud cloud = twoDensities();
  const double largest = 4 * std::sqrt(10.0);
  const ContactReference local(cloud, {.radius = largest, .kind = SurfaceKind::sphere, .localRadius = true});
  for (double x = -40; x < 40; x += 0.37) {
    CAPTURE(x);
    const SurfaceSample sample = local.surface({x, 1.3, 0.4});
    REQUIRE(sample.defined);
    CHECK(sample.distance == within(0.4, 1e-5));
    CHECK(sample.neighbours >= 12);
    if (x < -16) CHECK(sample.neighbours < 80);  // 500 lie within the largest radius
    if (x > 16) CHECK(sample.neighbours > 30);
  }
  const ContactReference fixed(cloud, {.radius = 4, .kind = SurfaceKind::sphere});
  CHECK(fixed.surface({40, 1.3, 0.4}).neighbours < 12);
}

TEST_CASE("the support radius widens with position noise above an eighth of a spacing, up to twice its size") {
  CHECK(wideningFor(0) == 1);
  CHECK(wideningFor(0.13) == 1);
  CHECK(wideningFor(0.25) == near(1.875, 0.01));
  CHECK(wideningFor(0.5) == 2);
  CHECK(wideningFor(std::numeric_limits<double>::quiet_NaN()) == 1);
}

TEST_CASE("a widened support radius smooths noise and biases a clean sphere as theory predicts") {
  const Scene clean = makeScene("sphere", 50'000);
  const double widening = wideningFor(0.25), wide = widening * clean.radius;
  CHECK(ContactReference(clean.cloud, {.radius = wide, .widening = widening}).surface({0, 0, 50}).distance ==
        near(averageSurfaceBias(wide, 50), 0.1));
  const PointCloud noisy = sampleShape(*makeShape("sphere"), {.count = 50'000, .noise = 0.25 * clean.spacing});
  const auto ripple = [&](const SurfaceOptions& options) {
    const ContactReference reference(noisy, options);
    double squares = 0;
    for (int i = 0; i < 400; ++i) {
      const DVec3 place = 50.0 * glm::normalize(randomNormal3(7, static_cast<std::uint64_t>(i)));
      const double height = reference.surface(place).distance / clean.spacing;
      squares += height * height / 400;
    }
    return std::sqrt(squares);
  };
  CHECK(ripple({.radius = clean.radius, .kind = SurfaceKind::sphere}) > 0.058);
  CHECK(ripple({.radius = wide, .kind = SurfaceKind::sphere, .widening = widening}) < 0.04);
}

TEST_CASE("a widened support radius shrinks back smoothly at an edge, except for a sharp surface") {
  const Scene cube = makeScene("cube", 50'000);
  const double widening = 1.6;
  for (const auto& [name, kind] : kSurfaceKinds) {
    CAPTURE(name);
    const ContactReference narrow(cube.cloud, {.radius = cube.radius, .kind = kind});
    const ContactReference widened(cube.cloud, {.radius = widening * cube.radius, .kind = kind, .widening = widening});
    const auto at = [&](const ContactReference& reference, double offEdge) {
      return reference.surface({50 - offEdge * cube.radius, 50 - 0.02 * cube.radius, 3.3}, {0, 1, 0});
    };
    for (const double offEdge : {0.05, 0.2, 0.4}) {
      const SurfaceSample wide = at(widened, offEdge), usual = at(narrow, offEdge);
      if (kind != SurfaceKind::sharp) {
        CHECK(wide.distance == near(usual.distance, 1e-6));
        CHECK(wide.neighbours == usual.neighbours);
        continue;
      }
      CHECK(wide.neighbours > 1.8 * usual.neighbours);
      const double height = wide.distance / cube.radius;
      CHECK(height == within(-0.02, offEdge > 0.1 ? 2e-4 : 0.05));
    }
    const auto flat = at(widened, 2.0);
    CHECK(flat.neighbours > 2.2 * at(narrow, 2.0).neighbours);
    CHECK(flat.distance == near(-0.02 * cube.radius, 1e-3));
    double steepest = 0;
    for (double offEdge = 0.1; offEdge < 2; offEdge += 0.01)
      steepest = std::max(steepest, std::abs(at(widened, offEdge).distance - at(widened, offEdge + 0.01).distance));
    CHECK(steepest < 0.02 * cube.radius);
  }
}

TEST_CASE("coincident, collinear or nearly coincident points give a flat surface, not a curved one") {
  for (const auto& [name, kind] : kSurfaceKinds) {
    CAPTURE(name);
    for (const double step : {0.0, 1e-7, 0.1}) {
      PointCloud cloud;
      for (int i = -3; i <= 3; ++i) {
        cloud.positions.emplace_back(step * i, 0, 0);
        cloud.normals.emplace_back(0, 0, 1);
      }
      const SurfaceSample sample = ContactReference(cloud, {.radius = 1, .kind = kind}).surface({0, 0, 0.2});
      REQUIRE(sample.defined);
      CHECK(sample.distance == near(0.2, 1e-6));
      CHECK(sample.normal.z == near(1, 1e-6));
    }
  }
}

}  // namespace palpate::surfaces_test
