// The result of each brush on the CPU back end, felt and measured. Needs no GPU.
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "tests/edit/surface_gaps.hpp"
#include "tests/scenes.hpp"

namespace palpate::sculpt_test {

namespace {

constexpr double kTick_s = 1e-3, kToolRadius = 6, kTau = 0.5;

BrushOptions brush(BrushKind kind, double strength = 0.5) {
  return {.kind = kind, .yieldDepth = kTau, .pushRate = 0.1, .radius = kToolRadius, .strength = strength};
}

// Straight lines between positions at a speed (model units per second), then a rest.
std::vector<Pose> along(const std::vector<DVec3>& places, double speed, int restTicks) {
  std::vector<Pose> poses{{.time_s = 0, .hip = places.front()}};
  const auto go = [&](const DVec3& hip) { poses.push_back({.time_s = kTick_s * double(poses.size()), .hip = hip}); };
  for (std::size_t leg = 1; leg < places.size(); ++leg) {
    const double way = glm::distance(places[leg - 1], places[leg]);
    const int ticks = std::max(1, static_cast<int>(std::ceil(way / (speed * kTick_s))));
    for (int k = 1; k <= ticks; ++k) go(glm::mix(places[leg - 1], places[leg], double(k) / ticks));
  }
  for (int k = 0; k < restTicks; ++k) go(places.back());
  return poses;
}

struct Played {
  PointCloud cloud;
  std::size_t touched = 0, lost = 0;  // ticks; lost: free again after the first touch
  Contact last;
  std::size_t changed = 0;
};

Played play(CpuTouch& touch, const PointCloud& before, const std::vector<Pose>& poses) {
  Played played{.cloud = before};
  for (const Pose& pose : poses) {
    played.last = touch.query(pose, 0);
    CHECK(played.last.valid);
    played.touched += played.last.touching;
    played.lost += !played.last.touching && played.touched > 0;
  }
  touch.finish();
  played.changed = touch.readBack(played.cloud);
  return played;
}

Played sculpt(const Scene& scene, BrushOptions options, const std::vector<Pose>& poses, bool resample = true,
              unsigned threads = 0) {
  options.resample = resample;
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = options, .threads = threads});
  return play(touch, scene.cloud, poses);
}

// On top of a sphere of radius 50: from the air to `depth` below the surface.
std::vector<DVec3> down(double depth) { return {{0, 0, 50.5}, {0, 0, 50 - depth}}; }

SurfaceGaps gapsAround(const PointCloud& cloud, const Scene& scene, const DVec3& center, double reach) {
  return SurfaceGapFinder(cloud, scene.radius, scene.spacing).find([&](const DVec3& place) {
    return glm::distance(place, center) < reach;
  });
}

}  // namespace

TEST_CASE("a push of 10 mm into a model of 100 mm leaves no hole, and the density is maintained") {
  const Scene scene = makeScene("sphere", 30'000);
  const auto path = along(down(10), 50, 60);
  const Played dent = sculpt(scene, brush(BrushKind::push), path);
  CHECK(dent.lost == 0);
  CHECK(dent.last.proxy.z < 41.5);
  const SurfaceGaps before = gapsAround(scene.cloud, scene, {0, 0, 50}, 12);
  const SurfaceGaps after = gapsAround(dent.cloud, scene, {0, 0, 46}, 12);
  CHECK(after.widest < 1.25);
  CHECK(after.closest > 0.35);
  CHECK(after.points > before.points + 100);
  CHECK(after.points < 3 * before.points);

  // The purpose of resampling: without it the same press tears the surface.
  const Played torn = sculpt(scene, brush(BrushKind::push), path, false);
  CHECK(torn.cloud.size() == scene.cloud.size());
  CHECK((torn.lost > 0 || gapsAround(torn.cloud, scene, {0, 0, 46}, 12).widest > 1.8));
}

TEST_CASE("a probe that slides through the dent never passes the surface") {
  const Scene scene = makeScene("sphere", 30'000);
  const Played dent = sculpt(scene, brush(BrushKind::push), along(down(10), 50, 50));
  CpuTouch touch(dent.cloud, {.radius = scene.radius});
  // The bottom is part of the brush's ball, at the proxy's final position; the HIP moves 0.6 below it, along two arcs.
  const DVec3 hip = down(10).back();
  const DVec3 center = hip + (kTau + kToolRadius) * glm::normalize(dent.last.proxy - hip);
  std::vector<Pose> poses{{.hip = center}};
  for (const auto& [x, y] : {std::pair{1.0, 0.0}, std::pair{0.6, 0.8}})
    for (int k = 0; k <= 400; ++k) {
      const double angle = 0.9 * std::sin(k * 2 * 3.14159265 / 400);
      const DVec3 away(x * std::sin(angle), y * std::sin(angle), -std::cos(angle));
      poses.push_back({.time_s = kTick_s * double(poses.size()), .hip = center + 6.6 * away});
    }
  const Played felt = play(touch, dent.cloud, poses);
  CHECK(felt.touched >= poses.size() - 2);
  CHECK(felt.lost == 0);
}

TEST_CASE("a hand at rest in its dent comes to rest: no points are added or removed any more") {
  const Scene scene = makeScene("sphere", 20'000);
  const Played first = sculpt(scene, brush(BrushKind::push), along(down(6), 50, 300));
  const Played longer = sculpt(scene, brush(BrushKind::push), along(down(6), 50, 500));
  CHECK(first.cloud.size() > scene.cloud.size() + 20);
  CHECK(longer.cloud.positions == first.cloud.positions);
}

TEST_CASE("carve cuts a closed crater, and a trench beside it, in the shape of its ball") {
  const Scene scene = makeScene("sphere", 30'000);
  const Played crater =
      sculpt(scene, brush(BrushKind::carve), along({{0, 0, 50.5}, {0, 0, 45}, {6, 0, 44.5}}, 50, 100));
  CHECK(crater.lost == 0);
  CHECK(gapsAround(crater.cloud, scene, {3, 0, 46}, 12).widest < 1.25);
  // The ball at the end of its path is empty, except for the surface of its wall.
  const DVec3 hip(6, 0, 44.5), outward = glm::normalize(crater.last.proxy - hip);
  const DVec3 center = hip + (kTau + kToolRadius) * outward;
  double deepest = 0;
  for (const Vec3& position : crater.cloud.positions)
    deepest = std::max(deepest, kToolRadius - glm::distance(DVec3(position), center));
  CHECK(deepest < 0.3 * scene.spacing);
}

TEST_CASE("inflate and grab stretch the surface without holes, and move it as specified") {
  const Scene scene = makeScene("sphere", 20'000);
  const Played bump = sculpt(scene, brush(BrushKind::inflate, 1), along(down(3), 50, 1200));
  CHECK(bump.lost == 0);
  CHECK(bump.last.proxy.z > 52);
  CHECK(gapsAround(bump.cloud, scene, {0, 0, 51}, 10).widest < 1.25);

  const Played pulled = sculpt(scene, brush(BrushKind::grab, 1), along({{0, 0, 50.5}, {0, 0, 47}, {8, 0, 47}}, 50, 50));
  CHECK(pulled.changed > 50);
  CHECK(gapsAround(pulled.cloud, scene, {4, 0, 48}, 14).widest < 1.25);
  // The grabbed points follow the hand sideways by at most half of the brush's radius; farther, the surface would fold.
  CHECK(std::ranges::any_of(pulled.cloud.positions, [&](const Vec3& place) {
    return glm::distance(DVec3(place), DVec3(kToolRadius / 2, 0, 47 + kTau)) < scene.spacing;
  }));
}

TEST_CASE("smooth removes noise and keeps the shape") {
  const Scene noisy = makeScene("sphere", 20'000, DVec3(0), 0.3);
  const auto deviation = [](const PointCloud& cloud) {
    double squares = 0, sum = 0;
    std::size_t count = 0;
    for (const Vec3& position : cloud.positions) {
      if (glm::distance(DVec3(position), DVec3(0, 0, 50)) > 3) continue;
      const double off = double{glm::length(DVec3(position))} - 50;
      squares += off * off;
      sum += off;
      ++count;
    }
    CHECK(count > 10);
    return std::pair(std::sqrt(squares / double(count)), sum / double(count));
  };
  const auto [before, meanBefore] = deviation(noisy.cloud);
  const Played smooth = sculpt(noisy, brush(BrushKind::smooth), along(down(1.5), 50, 300));
  const auto [after, meanAfter] = deviation(smooth.cloud);
  CHECK(before > 0.15);
  CHECK(after < 0.5 * before);
  CHECK(std::abs(meanAfter - meanBefore) < 0.1);
}

TEST_CASE("paint colours the points in reach and moves none") {
  const Scene scene = makeScene("sphere", 10'000);
  BrushOptions options = brush(BrushKind::paint, 0.2);
  options.color = {10, 20, 200, 255};
  const Played painted = sculpt(scene, options, along(down(2), 50, 300));
  CHECK(painted.cloud.positions == scene.cloud.positions);
  REQUIRE(painted.cloud.hasColors());
  std::size_t colored = 0;
  for (std::size_t i = 0; i < painted.cloud.size(); ++i) {
    const bool unpainted = painted.cloud.colors[i] == kUnpainted;
    const double distance = glm::distance(DVec3(painted.cloud.positions[i]), DVec3(0, 0, 50));
    if (distance < 4) CHECK(painted.cloud.colors[i] == options.color);
    if (distance > 7) CHECK(unpainted);
    colored += !unpainted;
  }
  CHECK(colored == painted.changed);
  CHECK(colored > 20);
}

TEST_CASE("the same strokes give the same cloud bit by bit with any number of threads") {
  const Scene scene = makeScene("bumpy-sphere", 15'000);
  const auto path = along({{0, 0, 60}, {0, 0, 44}, {5, 3, 44}}, 200, 30);
  for (const auto& [name, kind] : kBrushKinds) {
    CAPTURE(name);
    const Played one = sculpt(scene, brush(kind), path, true, 1), three = sculpt(scene, brush(kind), path, true, 3);
    CHECK(one.changed > 10);
    CHECK(one.cloud.positions == three.cloud.positions);
    CHECK(one.cloud.normals == three.cloud.normals);
    CHECK(one.cloud.colors == three.cloud.colors);
  }
}

TEST_CASE("the edits of the log, applied to the file's points, give the sculpted cloud") {
  const Scene scene = makeScene("sphere", 15'000);
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = brush(BrushKind::carve)});
  touch.edits()->keep();
  const Played crater = play(touch, scene.cloud, along({{0, 0, 50.5}, {0, 0, 43}, {8, 0, 43}}, 100, 20));
  EditBatch batch;
  touch.edits()->take(batch);
  std::vector<PointState> points = statesOf(scene.cloud);
  for (const PointState& point : batch.points) {
    if (point.number >= points.size()) points.resize(point.number + 1);
    points[point.number] = point;
  }
  const PointCloud followed = editedCloud(scene.cloud, points);
  CHECK(followed.positions == crater.cloud.positions);
  CHECK(followed.normals == crater.cloud.normals);
  CHECK(followed.size() != scene.cloud.size());
}

TEST_CASE("a brush larger than the model, and a stroke that removes nearly every point, complete") {
  const Scene small = makeScene("sphere", 600);
  for (const auto& [name, kind] : kBrushKinds) {
    CAPTURE(name);
    BrushOptions options = brush(kind, 1);
    options.radius = 1000;
    const Played played = sculpt(small, options, along({{0, 0, 50.5}, {0, 0, 40}}, 200, 20));
    CHECK(played.touched > 0);
    for (const Vec3& position : played.cloud.positions) CHECK(isFinite(position));
  }
  // The ball contains the whole model in one tick: its tip is far below.
  const Scene scene = makeScene("sphere", 3'000);
  BrushOptions all = brush(BrushKind::carve, 1);
  all.radius = 300;
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = all});
  const Played gone = play(touch, scene.cloud,
                           {{.hip = {0, 0, 51}}, {.hip = {0, 0, 48}}, {.hip = {0, 0, -250}}, {.hip = {0, 0, -250}}});
  // Except for a few: the last points define the surface, and so the ball's position, poorly.
  CHECK(30 * gone.cloud.size() < scene.cloud.size());
  CHECK(30 * gone.changed > 29 * scene.cloud.size());
  CHECK_FALSE(touch.query({.time_s = 1, .hip = {0, 0, 0}}, 0).touching);
  touch.finish();
}

}  // namespace palpate::sculpt_test
