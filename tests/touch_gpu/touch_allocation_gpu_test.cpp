#include <doctest/doctest.h>

#include <array>

#include "engine/touch/touch_side.hpp"
#include "tests/allocation_count.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"

namespace palpate::touch_allocation_gpu_test {

TEST_CASE(
    "no tick of a tool and two more hands on the GPU allocates memory on the querying thread, answered or bridged") {
  const Scene scene = makeScene("sphere", 30'000);
  Device& device = plainDevice();  // validation may allocate
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius,
                   .tools = {makeTool(ToolKind::pad, 64, 8), ToolShape(), makeTool(ToolKind::ball, 16, 4)}});
  std::size_t touched = 0;
  const auto query = [&](int i) {
    const double budget_us = i % 3 == 0 ? 1 : 0;  // 1: returns at once, late; 0: waits for the answer
    const double r = 50.5 - 0.1 * i, time_s = 1e-3 * i;
    const std::array poses{Pose{.time_s = time_s, .hip = {0, 0, r}}, Pose{.time_s = time_s, .hip = {r, 0, 0}},
                           Pose{.time_s = time_s, .hip = {0, r, 0}}};
    const auto answers = touch.query(poses, budget_us);
    touched += answers[0].touching && answers[1].valid && answers[2].valid;
  };
  query(0);  // a software driver compiles here
  countedThread = std::this_thread::get_id();
  allocations = 0;
  counting = true;
  for (int i = 1; i < 32; ++i) query(i);
  counting = false;
  countedThread = std::thread::id();
  CHECK(allocations == 0);
  CHECK(touched > 10);
  touch.finish();
}

}  // namespace palpate::touch_allocation_gpu_test
