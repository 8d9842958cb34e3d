#include <doctest/doctest.h>

#include "engine/contact/carried_patch.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/patch_contact.hpp"
#include "tests/allocation_count.hpp"
#include "tests/scenes.hpp"

namespace palpate::touch_allocation_test {

TEST_CASE("no tick on the CPU allocates memory on the querying thread, with or without edits") {
  const Scene scene = makeScene("sphere", 30'000);
  CpuTouchOptions options{.radius = scene.radius, .threads = 3};
  double limit_us = 500;
  SUBCASE("static") {}
  SUBCASE("edited") { options.brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8}; }
  SUBCASE("with a tool of many points") { options.tools = {makeTool(ToolKind::pad, 64, 8)}; }
  SUBCASE("with a tool of many points, edited") {
    options.tools = {makeTool(ToolKind::pad, 16, 8)};
    options.brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8};
  }
  SUBCASE("with four hands") { options.tools.resize(4); }
  SUBCASE("with more points in reach than a tick has time for") {
    options.radius = 30;
    limit_us = 5;
  }
  CpuTouch touch(scene.cloud, options);
  const std::array further{DVec3(49, 0, 0), DVec3(0, 49, 0), DVec3(0, -49, 0)};
  std::vector<Pose> poses(options.tools.size());
  const auto ask = [&](double time_s, double z, double budget_us) {
    for (std::size_t i = 0; i < poses.size(); ++i)
      poses[i] = {.time_s = time_s, .hip = i == 0 ? DVec3(0, 0, z) : further[i - 1]};
    touch.query(poses, budget_us);
  };
  ask(0, 51, 0);
  countedThread = std::this_thread::get_id();  // an edit has its own thread, whose lists grow with the stroke
  allocations = 0;
  counting = true;
  for (int i = 0; i < 60; ++i) ask(1e-3 * i, 50.5 - 0.05 * i, i % 2 ? 0 : limit_us);
  counting = false;
  CHECK(allocations == 0);
  if (limit_us < 10) CHECK(touch.bridged().thinned > 0);
  touch.finish();
  if (options.brush) CHECK(touch.report().editTimes_us.size() > 10);

  counting = true;
  int* volatile kept = new int(7);  // volatile, so that no compiler removes it
  delete kept;
  counting = false;
  CHECK(allocations == 1);  // the counter counts
  countedThread = std::thread::id();
}

TEST_CASE("neither an answer from a patch nor an update of the patch allocates memory") {
  const Scene scene = makeScene("sphere", 30'000);
  std::vector<Vec4> points;
  for (std::size_t i = 0; i < scene.cloud.size() && points.size() < 2 * shared::kMaxCarriedPoints; ++i) {
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

}  // namespace palpate::touch_allocation_test
