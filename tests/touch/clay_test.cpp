// A stroke produces the shape that the hand's motion defines: depth, height and layers, compared with analytic truth.
// Needs no GPU; trench_test.cpp has the cases of each back end.
#include <doctest/doctest.h>

#include "engine/touch/cpu_touch.hpp"
#include "tests/clay.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"

namespace palpate::clay_test {

namespace {

ClayResult mouldOnCpu(const Scene& scene, const BrushOptions& brush, const ClayGesture& gesture, int every = 1,
                      EditSize size = EditSize::whole) {
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = brush, .editSize = size, .threads = 1});
  return mould(touch, scene, gesture, every);
}

}  // namespace

TEST_CASE("a gesture leaves the same trench if the machine completes only half or a third of the ticks") {
  const Scene scene = makeScene("plane", 6'000);
  for (const BrushKind kind : {BrushKind::push, BrushKind::carve}) {
    CAPTURE(static_cast<int>(kind));
    const ClayGesture gesture = clayDrag(scene, 3, 200);
    const ClayResult all = mouldOnCpu(scene, clayBrush(kind), gesture);
    for (const int every : {2, 3}) {
      CAPTURE(every);
      const ClayResult some = mouldOnCpu(scene, clayBrush(kind), gesture, every);
      checkClay(some, 3);
      CHECK(some.deepest == near(all.deepest, 0.05));
      CHECK(some.trenchLeast == near(all.trenchLeast, 0.1));
    }
  }
}

TEST_CASE("in real time a dense cloud is moulded a part at a time, and to the same shape" * kMoreInFull) {
  std::size_t differing = 0;
  for (const std::size_t count : byTier<std::vector<std::size_t>>({40'000}, {40'000, 100'000}))
    for (const double speed : byTier<std::vector<double>>({100}, {50, 200, 500})) {
      Scene scene = makeScene("plane", count);
      scene.radius *= 2;  // as on a noisy scan: two hundred neighbours
      for (const BrushKind kind : {BrushKind::push, BrushKind::carve}) {
        CAPTURE(count);
        CAPTURE(speed);
        CAPTURE(static_cast<int>(kind));
        const ClayGesture gesture = clayDrag(scene, 3, speed);
        const ClayResult whole = mouldOnCpu(scene, clayBrush(kind), gesture);
        const ClayResult parts = mouldOnCpu(scene, clayBrush(kind), gesture, 1, EditSize::tick);
        differing += parts.cloud.positions != whole.cloud.positions;
        checkClay(parts, 3);
        CHECK(parts.deepest == near(whole.deepest, 0.1));
        CHECK(parts.trenchLeast == near(whole.trenchLeast, 0.15));
        CHECK(std::abs(static_cast<double>(parts.added) - static_cast<double>(whole.added)) <=
              0.04 * static_cast<double>(whole.changed));
      }
    }
  CHECK(differing > 0);
}

TEST_CASE("a dwelling hand adds nothing, and lifting it changes nothing, with every brush except grab") {
  const Scene scene = makeScene("plane", 4'000);
  for (const auto& [name, kind] : kBrushKinds) {
    if (kind == BrushKind::grab) continue;
    CAPTURE(name);
    ClayGesture gesture = clayDrag(scene, 3, 100);
    const std::size_t lifts = gesture.hips.size() - 170;  // 100 ticks of rest and 70 upwards
    BrushOptions brush = clayBrush(kind);
    brush.strength = 1;
    CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = brush, .threads = 1});
    double time_s = 0;
    const auto go = [&](const DVec3& hip) { touch.query({.time_s = time_s += 1e-3, .hip = hip}, 0); };
    for (std::size_t k = 0; k < lifts; ++k) go(gesture.hips[k]);
    const auto points = [&] {
      PointCloud now = scene.cloud;
      touch.readBack(now);
      return now;
    };
    for (int k = 0; k < 900; ++k) go(gesture.hips[lifts - 1]);
    const PointCloud rested = points();
    // Flat and smooth areas stay.
    const bool alters = kind != BrushKind::smooth && kind != BrushKind::flatten;
    double farthest = 0;
    for (std::size_t i = 0; i < scene.cloud.size(); ++i)
      farthest = std::max(farthest, double{glm::distance(rested.positions[i], scene.cloud.positions[i])});
    CHECK((farthest > 0.1 || rested.colors != scene.cloud.colors) == alters);
    for (int k = 0; k < 50; ++k) go(gesture.hips[lifts - 1]);
    CHECK(points().positions == rested.positions);
    for (std::size_t k = lifts; k < gesture.hips.size(); ++k) go(gesture.hips[k]);
    CHECK(points().positions == rested.positions);
    CHECK(points().normals == rested.normals);
    CHECK(points().colors == rested.colors);
  }
}

TEST_CASE("inflate raises the surface by the depth of the hand, smoothly, and stops") {
  const Scene scene = makeScene("plane", 4'000);
  BrushOptions brush = clayBrush(BrushKind::inflate);
  brush.strength = 1;
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = brush, .threads = 1});
  double time_s = 0;
  for (int k = 0; k < 50; ++k) touch.query({.time_s = time_s += 1e-3, .hip = {0, 0, 1 - 0.07 * k}}, 0);
  const auto hold = [&](int ticks) {
    for (int k = 0; k < ticks; ++k) touch.query({.time_s = time_s += 1e-3, .hip = {0, 0, -2.5}}, 0);
    PointCloud now = scene.cloud;
    touch.readBack(now);
    return now;
  };
  const PointCloud raised = hold(1200);
  double highest = 0;
  for (const Vec3& place : raised.positions) {
    const double r = glm::length(DVec3(place.x, place.y, 0)) / kClayRadius;
    CHECK(static_cast<double>(place.z) < 2 * std::max(0.0, 1 - r * r) + 0.25);
    highest = std::max(highest, static_cast<double>(place.z));
  }
  CHECK(highest == near(2, 0.1));
  CHECK(hold(1000).positions == raised.positions);
}

// The depth asked for less the yield depth, to 5 % at up to 100 mm/s and 10 % beyond; nothing is raised.
void checkDepth(const ClayResult& r, double depth, double speed) {
  const double expected = depth - 0.5;
  CHECK(r.deepest >= (speed <= 100 ? 0.95 : 0.9) * expected);
  CHECK(r.deepest <= 1.01 * expected);
  CHECK(r.highest <= 0.1);
}

TEST_CASE("all brushes keep their bounds of depth, height and folds at all depths, speeds and shares of the ticks" *
          kFull) {
  const Scene scene = makeScene("plane", 20'000);
  for (const auto& [name, kind] : kBrushKinds)
    for (const double speed : {20.0, 100.0, 500.0})
      for (const double depth : {2.0, 3.0, 4.0, 9.0, 18.0})
        for (const int every : {1, 3}) {
          if (every > 1 && speed < 100) continue;
          const ClayResult r = mouldOnCpu(scene, clayBrush(kind), clayDrag(scene, depth, speed), every);
          MESSAGE(name << ", " << speed << " mm/s, " << depth << " mm, 1/" << every << " of the ticks: deepest "
                       << r.deepest << ", highest " << r.highest << ", trench " << r.trenchLeast << " to "
                       << r.trenchMost << ", " << r.added << " new, " << r.changed << " changed, second layer "
                       << 100 * r.secondLayer << " %");
          if (kind != BrushKind::grab) CHECK(r.secondLayer <= 0.01);
          if (kind == BrushKind::push || kind == BrushKind::carve) checkDepth(r, depth, speed);
        }
}

TEST_CASE("a quick hand pushes as deep as a slow one") {
  const Scene scene = makeScene("plane", 20'000);
  for (const double speed : {100.0, 500.0})
    for (const int every : {1, 3}) {
      CAPTURE(speed);
      CAPTURE(every);
      checkDepth(mouldOnCpu(scene, clayBrush(BrushKind::push), clayDrag(scene, 3, speed), every), 3, speed);
    }
}

}  // namespace palpate::clay_test
