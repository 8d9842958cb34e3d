#include "haptics/builtin_path.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/core/error.hpp"
#include "tests/near.hpp"

namespace palpate::builtin_path_test {
namespace {

struct Model {
  std::unique_ptr<AnalyticShape> shape;
  PointCloud cloud;
  ModelScale scale;

  Model(std::string_view name, double size, const DVec3& center, std::size_t count = 60'000, double noise = 0)
      : shape(makeShape(name, size, center)),
        cloud(sampleShape(*shape, {.count = count, .noise = noise})),
        scale(ModelScale::fitting(boundsOf(cloud).longestSide())) {}

  double height_mm(const DVec3& p) const { return scale.toMm(shape->signedDistance(p)); }
};

struct Deviation {
  double lowest = 1e9, highest = -1e9;
};

/// Signed distances along the slide, from the end of its descent.
Deviation alongSlide(const Model& model, const Path& path) {
  constexpr double kDown_s = 4.0 / 25;
  Deviation result;
  for (double t = kDown_s; t <= path.duration_s(); t += 0.002) {
    const double height = model.height_mm(path.at(t));
    result.lowest = std::min(result.lowest, height);
    result.highest = std::max(result.highest, height);
  }
  return result;
}

void checkPress(const Model& model, double penetration_mm, double tolerance_mm) {
  const Path path = builtinPath("press", model.cloud, model.scale, penetration_mm);
  CHECK(path.duration_s() < 0.6);
  CHECK(path.duration_s() > 0.3);
  CHECK(model.height_mm(path.at(0)) == within(3, tolerance_mm));
  CHECK(model.height_mm(path.at(path.duration_s())) == within(-penetration_mm, tolerance_mm));
  CHECK(path.at(path.duration_s() - 0.24) == path.at(path.duration_s()));
  // It descends steadily: nothing else is in the way.
  for (double t = 0.01; t < 0.2; t += 0.01)
    CHECK(model.height_mm(path.at(t)) <= model.height_mm(path.at(t - 0.01)) + 1e-9);
}

void checkOrbit(const Model& model) {
  const Path path = builtinPath("orbit", model.cloud, model.scale);
  CHECK(path.duration_s() == near(2, 1e-6));
  CHECK(glm::distance(path.at(0), path.at(2)) < 1e-9 * model.shape->size());
  const Bounds box = boundsOf(model.cloud);
  for (double t = 0; t <= 2; t += 0.001) {
    const DVec3 p = path.at(t) - model.cloud.origin;
    const bool inside = p.x > box.min.x && p.x < box.max.x && p.z > box.min.z && p.z < box.max.z;
    REQUIRE_FALSE(inside);
  }
}

}  // namespace

TEST_CASE("press, slide and orbit work on shapes of any size and position") {
  struct Case {
    const char* name;
    double size;
    DVec3 center;
    double tolerance_mm;
  };
  // The averaged surface is inside a curved one by about reach^2 / (10 radius).
  const Case cases[] = {
      {"plane", 100, DVec3(0), 0.01},   {"cube", 100, DVec3(0), 0.01},
      {"sphere", 100, DVec3(0), 0.1},   {"torus", 100, DVec3(0), 0.1},
      {"sphere", 0.02, DVec3(5), 0.1},  {"sphere", 100, DVec3(1e6, -1e6, 1e6), 0.1},
      {"torus", 2000, DVec3(1e6), 0.1}, {"plane", 1, DVec3(1e6, 0, 0), 0.01},
  };
  for (const Case& example : cases) {
    const std::string what = fmt::format("{} of {} at {}", example.name, example.size, example.center.x);
    CAPTURE(what);
    const Model model(example.name, example.size, example.center);
    checkPress(model, 2, example.tolerance_mm);
    checkOrbit(model);
    const Path slide = builtinPath("slide", model.cloud, model.scale);
    const Deviation deviation = alongSlide(model, slide);
    CHECK(deviation.lowest > -1 - example.tolerance_mm);
    CHECK(deviation.highest < -1 + example.tolerance_mm);
    const double length_mm = model.scale.toMm(glm::distance(slide.at(4.0 / 25), slide.at(slide.duration_s())));
    CHECK(length_mm > 15);
    CHECK(length_mm < 20.5);  // in a hollow the HIP's path is longer than that on the surface
  }
}

TEST_CASE("press and slide stay near their depth on the detailed sculpture") {
  const Model model("sculpture", 100, DVec3(0), 200'000);
  checkPress(model, 2, 0.15);
  const Deviation deviation = alongSlide(model, builtinPath("slide", model.cloud, model.scale));
  CHECK(deviation.lowest > -1.2);
  CHECK(deviation.highest < -0.4);  // under the step of a scale the nearest surface is the step's
  checkOrbit(model);
}

TEST_CASE("a noisy cloud is touched near its true surface") {
  const Model model("sphere", 100, DVec3(0), 60'000, 0.3);
  checkPress(model, 2, 0.3);
}

TEST_CASE("the target of a built-in path faces the default camera") {
  for (const char* name : {"sphere", "torus", "cube", "sculpture"}) {
    CAPTURE(name);
    const Model model(name, 100, DVec3(0), 30'000);
    const Path path = builtinPath("press", model.cloud, model.scale);
    const DVec3 outward = glm::normalize(path.at(0) - path.at(path.duration_s()));
    CHECK(glm::dot(outward, glm::normalize(DVec3(0.35, 0.45, 0.82))) > 0.45);
  }
}

TEST_CASE("the scan path taps 25 times and is outside between taps") {
  const Model model("sphere", 100, DVec3(0));
  const Path path = builtinPath("scan", model.cloud, model.scale);
  int taps = 0;
  double deepest = 0;
  bool inside = false;
  for (double t = 0; t <= path.duration_s(); t += 0.001) {
    const double height = model.height_mm(path.at(t));
    deepest = std::min(deepest, height);
    if (!inside && height < -0.5) ++taps;
    inside = height < (inside ? 0.0 : -0.5);
  }
  CHECK(taps == 25);
  CHECK(deepest == near(-1, 0.1));
  CHECK(model.height_mm(path.at(path.duration_s())) == near(2, 0.1));
}

TEST_CASE("the same cloud gives the same built-in path") {
  const Model model("torus", 100, DVec3(0), 20'000);
  for (const std::string_view name : builtinPathNames()) {
    const Path a = builtinPath(name, model.cloud, model.scale), b = builtinPath(name, model.cloud, model.scale);
    REQUIRE(a.keys().size() == b.keys().size());
    for (std::size_t i = 0; i < a.keys().size(); ++i) {
      CHECK(a.keys()[i].t_s == b.keys()[i].t_s);
      CHECK(a.keys()[i].position == b.keys()[i].position);
    }
  }
}

TEST_CASE("tiny and degenerate clouds still give finite paths") {
  PointCloud cloud;
  SUBCASE("one point") {
    cloud.positions = {{1, 2, 3}};
    cloud.normals = {{0, 0, 1}};
  }
  SUBCASE("the same point many times, with normals on both sides") {
    cloud.positions.assign(5000, {1, 2, 3});
    cloud.normals.assign(5000, {0, 0, 1});
    for (std::size_t i = 0; i < 5000; i += 2) cloud.normals[i].z = -1;
  }
  SUBCASE("two points that face away from the viewer") {
    cloud.positions = {{1, 2, 3}, {4, 5, 6}};
    cloud.normals.assign(2, {0, 0, -1});
  }
  const ModelScale scale = ModelScale::fitting(boundsOf(cloud).longestSide());
  for (const std::string_view name : builtinPathNames()) {
    const Path path = builtinPath(name, cloud, scale);
    for (const PathKey& key : path.keys()) CHECK(isFinite(key.position));
  }
}

TEST_CASE("a built-in path for a cloud that cannot be touched is refused with a reason") {
  const PointCloud empty;
  for (const std::string_view name : builtinPathNames()) CHECK_THROWS_AS(builtinPath(name, empty, {}), Error);
  PointCloud bare;
  bare.positions = {{1, 2, 3}, {4, 5, 6}};
  CHECK_THROWS_WITH_AS(builtinPath("press", bare, {}),
                       "the model has no normals, and a built-in path needs them; load it with estimated normals",
                       Error);
  CHECK_NOTHROW(builtinPath("orbit", bare, {}));
  CHECK_THROWS_WITH_AS(builtinPath("pres", bare, {}),
                       "unknown built-in path 'pres'; did you mean 'press'? Choose press, slide, scan, orbit",
                       UsageError);
  CHECK_THROWS_AS(builtinPath("press", bare, {}, 0), UsageError);
  CHECK_THROWS_AS(builtinPath("press", bare, {}, -1), UsageError);
}

}  // namespace palpate::builtin_path_test
