#include <doctest/doctest.h>

#include "engine/contact/patch_fetch.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/patch_contact.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/allocation_count.hpp"
#include "tests/scenes.hpp"

namespace palpate {

TEST_CASE("no tick on the CPU allocates memory on the thread that asks, whether it edits or not") {
  const Scene scene = makeScene("sphere", 30'000);
  CpuTouchOptions options{.radius = scene.radius, .threads = 3};
  SUBCASE("static") {}
  SUBCASE("edited") { options.brush = BrushOptions{.tau = 0.3, .beta = 0.2, .toolRadius = 8}; }
  SUBCASE("with a tool of many points") { options.tool = makeTool(ToolKind::pad, 64, 8); }
  SUBCASE("with such a tool, edited") {
    options.tool = makeTool(ToolKind::pad, 16, 8);
    options.brush = BrushOptions{.tau = 0.3, .beta = 0.2, .toolRadius = 8};
  }
  std::optional<DVec3> second;
  SUBCASE("with a second hand") { second = DVec3(49, 0, 0); }
  CpuTouch touch(scene.cloud, options);
  touch.query({.hip = {0, 0, 51}, .secondHip = second}, 0);
  countedThread = std::this_thread::get_id();  // an edit has a thread of its own, whose lists grow with the stroke
  allocations = 0;
  counting = true;
  for (int i = 0; i < 60; ++i)
    touch.query({.time_s = 1e-3 * i, .hip = {0, 0, 50.5 - 0.05 * i}, .secondHip = second}, i % 2 ? 0 : 500);
  counting = false;
  CHECK(allocations == 0);
  touch.finish();
  if (options.brush) CHECK(touch.editTimes_us().size() > 10);

  counting = true;
  int* volatile kept = new int(7);  // volatile, so that no compiler leaves it out
  delete kept;
  counting = false;
  CHECK(allocations == 1);  // the counter counts
  countedThread = std::thread::id();
}

TEST_CASE("no tick of a tool and a second hand on the GPU allocates memory on the thread that asks, answered or held") {
  const Scene scene = makeScene("sphere", 30'000);
  Device device({.gpu = "", .validate = false});  // which allocates as it likes
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius, .tool = makeTool(ToolKind::pad, 64, 8), .secondHand = true});
  std::size_t touched = 0;
  const auto query = [&](int i) {
    const double budget_us = i % 3 == 0 ? 1 : 0;  // at once, and so late; or as long as it takes
    const Pose pose{.time_s = 1e-3 * i, .hip = {0, 0, 50.5 - 0.05 * i}, .secondHip = DVec3(51 - 0.05 * i, 0, 0)};
    touched += touch.query(pose, budget_us).touching && touch.second().valid;
    touch.prepare();
  };
  touch.query({.hip = {0, 0, 52}}, 0);  // a software driver compiles now
  query(0);
  countedThread = std::this_thread::get_id();
  allocations = 0;
  counting = true;
  for (int i = 1; i < 60; ++i) query(i);
  counting = false;
  countedThread = std::thread::id();
  CHECK(allocations == 0);
  CHECK(touched > 20);
  touch.finish();
}

TEST_CASE("no answer from a patch allocates memory, nor does taking one") {
  const Scene scene = makeScene("sphere", 30'000);
  std::vector<Vec4> points;
  for (std::size_t i = 0; i < scene.cloud.size() && points.size() < 2 * shared::kMostCarriedPoints; ++i) {
    if (scene.cloud.positions[i].z < 47) continue;
    points.emplace_back(scene.cloud.positions[i], 0);
    points.emplace_back(scene.cloud.normals[i], 0);
  }
  PatchContact patch({.radius = scene.radius, .kind = SurfaceKind::sharp}, 0.3, DVec3(0));
  std::size_t touched = 0;
  allocations = 0;
  counting = true;
  for (int i = 0; i < 60; ++i) {
    if (i % 20 == 0) patch.take({.centre = {0, 0, 50}, .reach = 3 * scene.radius, .points = points}, {});
    patch.heard(1e-3 * i);
    touched += patch.answer({.time_s = 1e-3 * i, .hip = {0.1 * i, 0, 50.5 - 0.05 * i}}).touching;
  }
  counting = false;
  CHECK(allocations == 0);
  CHECK(touched > 10);
}

}  // namespace palpate
