#include <doctest/doctest.h>

#include "engine/matter/matter_touch.hpp"
#include "engine/matter/matter_world.hpp"
#include "tests/allocation_count.hpp"
#include "tests/matter/soft_on_cpu.hpp"

namespace palpate::matter_allocation_test {

TEST_CASE("in real time no tick in matter allocates memory on the querying thread") {
  MatterScene scene{.box_mm = {80, 120, 80}, .fill_mm = {80, 40, 80}, .spacing_mm = 10};
  scene.tool = usualTool(scene);
  MatterTouch touch(std::make_unique<MatterWorld>(scene, MatterOptions{.threads = 1, .tools = 1}),
                    {.hands = 1, .realtime = true});
  std::size_t answered = 0;
  countedThread = std::this_thread::get_id();
  allocations = 0;
  counting = true;
  for (int i = 0; i < 100; ++i) {
    answered += touch.query({.time_s = 1e-3 * i, .hip = {40, 60 - 0.4 * i, 40}}, i % 2 ? 0 : 50).touching;
  }
  counting = false;
  CHECK(allocations == 0);
  countedThread = std::thread::id();
  CHECK(answered > 10);
  touch.finish();
}

TEST_CASE("in real time no tick on a soft body allocates memory on the querying thread") {
  SoftTouching options;
  options.realtime = true;
  SoftScene block(bareBlock(), options, feltOnCpu);
  std::size_t touched = 0;
  const auto ask = [&](int i) {
    touched += block.touch().query({.time_s = 1e-3 * i, .hip = {50, 42 - 0.04 * i, 50}}, 500).touching;
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  };
  for (int i = 0; i < 5; ++i) ask(i);
  countedThread = std::this_thread::get_id();
  allocations = 0;
  counting = true;
  for (int i = 5; i < 150; ++i) ask(i);
  counting = false;
  CHECK(allocations == 0);
  countedThread = std::thread::id();
  CHECK(touched > 10);
  block.touch().finish();
}

}  // namespace palpate::matter_allocation_test
