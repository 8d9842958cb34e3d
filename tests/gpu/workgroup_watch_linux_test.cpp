#include "engine/gpu/workgroup_watch.hpp"

#include <algorithm>
#include <array>

#include "engine/core/clock.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/test_shaders.hpp"
#include "shaders/test_watched.hpp"
#include "shaders/watched.hpp"
#include "tests/gpu/add_one.h"
#include "tests/gpu_fixture.hpp"
#include "tests/lost_gpu/lost_gpu.hpp"

namespace palpate::workgroup_watch_test {

TEST_CASE("the lifetime of a workgroup is given in microseconds, whatever the period of the GPU's timestamps") {
  const LostGpuLayer layer("coarse");
  Device device({.gpu = "", .validation = askedCoreValidation()});
  REQUIRE(device.timestampPeriod_ns() == 1000);
  if (!WorkgroupWatch::isPossible(device)) {
    MESSAGE("skipped: this GPU's shaders have no clock");
    return;
  }
  constexpr std::array kTwins{&shader_code::watched_gpu_spin, &shader_code::watched_gpu_read_clock};
  const WorkgroupWatch watch(device, kTwins);
  const ComputePipeline spin(device, shader_code::gpu_spin,
                             {.workgroupSize = 32, .pushBytes = sizeof(shared::AddOneArgs)});
  const Buffer value = Buffer::of<std::uint32_t>(device, 1, Memory::device, "value");
  upload(device, value, std::vector<std::uint32_t>{1});
  CHECK(watch.longest().empty());
  CommandList list(device, device.throughputQueue(), "spin");
  list.begin();
  // lavapipe ends a loop after this number of turns.
  list.dispatch(spin, 1,
                shared::AddOneArgs{.from = value.address(), .to = value.address(), .count = 1 << 16, .unused = 0});
  list.end();
  device.throughputQueue().run(list);  // compiles the shader
  double longest_us = 0, shortest_us = 1e12;
  for (int run = 0; run < 10; ++run) {
    const Stopwatch since;
    device.throughputQueue().run(list);
    longest_us = std::max(longest_us, since.elapsed_us());
    shortest_us = std::min(shortest_us, since.elapsed_us());
  }
  const auto lives = watch.longest();
  REQUIRE(lives.size() == 1);
  CHECK(lives[0].pass == "gpu_spin");
  CHECK(lives[0].longest_us < 3 * longest_us);  // the first run is not in it
  CHECK(lives[0].longest_us > 0.3 * shortest_us);
}

}  // namespace palpate::workgroup_watch_test
