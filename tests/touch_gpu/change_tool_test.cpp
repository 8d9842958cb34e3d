// Brush, surface and method changes while a cloud is touched, and a lifted stylus.
#include <algorithm>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/edit/history.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/history_steps.hpp"
#include "tests/scenes.hpp"

namespace palpate::change_tool_test {

namespace {

BrushOptions brush(BrushKind kind, double radius = 8) {
  return {.kind = kind, .yieldDepth = 0.3, .pushRate = 0.2, .radius = radius, .strength = 0.5};
}

// Either back end, with a brush that pushes, and with colours for one that paints later.
std::unique_ptr<TouchBackend> backend(Device& device, const Scene& scene, bool gpu) {
  if (gpu)
    return std::make_unique<TouchSide>(
        device, scene.cloud, TouchOptions{.radius = scene.radius, .brush = brush(BrushKind::push), .paintable = true});
  return std::make_unique<CpuTouch>(scene.cloud,
                                    CpuTouchOptions{.radius = scene.radius, .brush = brush(BrushKind::push)});
}

// Lowers the stylus onto the sphere from `direction`, presses `depth` deep, and lifts it again.
Contact press(TouchBackend& touch, const DVec3& direction, double depth, int ticks = 24) {
  Contact deepest;
  touch.resetHand(0);
  for (int i = 0; i <= 2 * ticks; ++i) {
    const double share = 1 - std::abs(i - ticks) / double(ticks);
    const Contact contact = touch.query({.hip = (52 - (2 + depth) * share) * direction}, 0);
    CHECK(contact.valid);
    if (i == ticks) deepest = contact;
  }
  return deepest;
}

struct Told {
  explicit Told(const Scene& scene) : history(scene.cloud, {1 << 28}) {}
  History history;
  EditBatch batch;
  void take(TouchBackend& touch) {
    batch.clear();
    touch.edits()->take(batch);
    history.follow(batch);
  }
};

}  // namespace

TEST_CASE_FIXTURE(CoreGpuFixture, "each brush works after a change of brush, and all edits are reported and undone") {
  const Scene scene = makeScene("sphere", 8'000);
  for (const bool gpu : {true, false}) {
    CAPTURE(gpu);
    const auto touch = backend(device, scene, gpu);
    Told told(scene);
    touch->edits()->keep();
    press(*touch, {0, 0, 1}, 3);
    touch->setBrush(brush(BrushKind::paint, 10));
    press(*touch, {0, 1, 0}, 2);
    touch->setBrush(brush(BrushKind::inflate, 12));
    press(*touch, {1, 0, 0}, 2, 60);
    touch->setBrush(std::nullopt);
    press(*touch, {-1, 0, 0}, 3);
    touch->setBrush(brush(BrushKind::carve, 5));
    press(*touch, {0, -1, 0}, 3);
    touch->finish();
    told.take(*touch);
    CHECK(told.history.counts().strokes == 4);  // feeling makes no stroke

    double lowest = 100, highest = 0, behind = 100, carved = 100;
    std::size_t red = 0;
    for (const PointState& point : told.history.points()) {
      const DVec3 p(point.position);
      if (point.gone) continue;
      const double r = glm::length(p);
      if (p.z > 45) lowest = std::min(lowest, r);
      if (p.x > 45) highest = std::max(highest, r);
      if (p.y < -45) carved = std::min(carved, r);
      if (p.x < -45) behind = std::min(behind, r);
      red += p.y > 40 && point.color != 0 && (point.color & 0xff) > (point.color >> 8 & 0xff);
    }
    CHECK(lowest < 48.5);
    CHECK(highest > 50.1);
    CHECK(behind > 49.9);
    CHECK(carved < 48.5);
    CHECK(red > 20);

    for (int stroke = 0; stroke < 4; ++stroke) {
      touch->edits()->change(undone(told.history));
      told.take(*touch);
    }
    CHECK(changedPoints(scene.cloud, told.history.points()) == 0);
    PointCloud back = scene.cloud;
    CHECK(touch->readBack(back) == 0);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "a larger tool reaches further than the one before it") {
  const Scene scene = makeScene("sphere", 8'000);
  for (const bool gpu : {true, false}) {
    CAPTURE(gpu);
    const auto touch = backend(device, scene, gpu);
    touch->setBrush(brush(BrushKind::inflate, 3));
    Told told(scene);
    touch->edits()->keep();
    const auto reach = [&](const DVec3& direction) {
      press(*touch, direction, 2);
      touch->finish();
      told.take(*touch);
      double widest = 0;
      for (const PointState& point : told.batch.points)
        if (!point.gone) widest = std::max(widest, glm::length(glm::cross(DVec3(point.position), direction)));
      return widest;
    };
    const double narrow = reach({0, 0, 1});
    touch->setBrush(brush(BrushKind::inflate, 15));
    const double wide = reach({0, 1, 0});
    CHECK(narrow > 1);
    CHECK(narrow < 8);
    CHECK(wide > 10);
  }
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "after a change of surface, friction or method the answers are those of a new start") {
  const Scene scene = makeScene("sphere", 8'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .surface = SurfaceKind::average});
  const Contact average = press(touch, {0, 0, 1}, 2);
  CHECK(average.proxy.z < 49.98);  // the average surface sinks into curvature
  touch.setContact(SurfaceKind::sphere, 0, "fused");
  const Contact sphere = press(touch, {0, 0, 1}, 2);
  CHECK(std::abs(sphere.proxy.z - 50) < 0.01);
  for (const auto& [name, method] : builtMethods()) {
    CAPTURE(name);
    touch.setContact(SurfaceKind::sphere, 0, name);
    CHECK(glm::distance(press(touch, {0, 0, 1}, 2).proxy, sphere.proxy) < 1e-4);
  }
  touch.setContact(SurfaceKind::average, 0, "fused");
  CHECK(press(touch, {0, 0, 1}, 2).proxy == average.proxy);
  CpuTouch cpu(scene.cloud, {.radius = scene.radius, .surface = SurfaceKind::average});
  cpu.setContact(SurfaceKind::sphere, 0, "direct");
  CHECK(glm::distance(press(cpu, {0, 0, 1}, 2).proxy, sphere.proxy) < 1e-3);
}

TEST_CASE_FIXTURE(GpuFixture, "a stylus that is put down behind a surface does not count as having crossed it") {
  const Scene scene = makeScene("sphere", 8'000);
  for (const bool gpu : {true, false}) {
    CAPTURE(gpu);
    const auto touch = backend(device, scene, gpu);
    CHECK(!touch->query({.hip = {0, 0, 53}}, 0).touching);
    const Contact through = touch->query({.hip = {0, 0, 40}}, 0);
    CHECK(through.touching);  // the motion crossed the surface
    touch->resetHand(0);
    CHECK(!touch->query({.hip = {0, 0, 53}}, 0).touching);
    touch->resetHand(0);
    const Contact inside = touch->query({.hip = {0, 0, 40}}, 0);
    CHECK(!inside.touching);
    CHECK(glm::distance(inside.proxy, DVec3(0, 0, 40)) < 1e-5);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "a late answer from before the stylus was lifted is not used afterwards") {
  const Scene scene = makeScene("sphere", 8'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius});
  for (int i = 0; i < 30; ++i) touch.query({.time_s = i * 1e-3, .hip = {0, 0, 53 - 0.2 * i}}, 0);  // until it touches
  // Queried without waiting for the answer.
  touch.query({.time_s = 0.03, .hip = {0, 0, 47}}, 1e-3);
  touch.resetHand(0);
  const Contact far = touch.query({.time_s = 0.031, .hip = {0, 80, 0}}, 0);
  CHECK(!far.touching);
  CHECK(glm::distance(far.proxy, DVec3(0, 80, 0)) < 1e-5);
}

}  // namespace palpate::change_tool_test
