#include "engine/cuda/cuda_measure.hpp"

#include <algorithm>

#include "engine/core/clock.hpp"
#include "engine/core/statistics.hpp"
#include "tests/cuda/cuda_fixture.hpp"

namespace palpate::cuda_measure_test {

TEST_CASE("the CUB sort is timed once per repetition") {
  NEEDS_CUDA_DEVICE();
  std::mt19937 random(1);
  for (const std::size_t count : {1, 1000, 1'000'000}) {
    std::vector<std::uint32_t> keys(count);
    for (auto& key : keys) key = random();
    for (const unsigned bits : {18u, 32u}) {
      const std::vector<double> times = timeCubSort(keys, bits, 30);
      CHECK(times.size() == 30);
      CHECK(std::ranges::all_of(times, [](double time_us) { return time_us > 0 && time_us < 1e6; }));
      MESSAGE("sort of " << count << " pairs by " << bits << " bits: " << summarize(times).p50 << " us");
    }
  }
}

TEST_CASE("the CUB build is timed once per repetition") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sculpture", 1'000'000);
  const HashGrid grid = makeHashGrid(Vec3(boundsOf(scene.cloud).min), scene.radius, scene.cloud.size());
  const std::vector<double> times = timeCubBuild(scene.cloud, grid, 50);
  CHECK(times.size() == 50);
  CHECK(std::ranges::all_of(times, [](double time_us) { return time_us > 0 && time_us < 1e6; }));
  MESSAGE("build of " << scene.cloud.size() << " points: " << summarize(times).p50 << " us");
}

TEST_CASE("back-to-back ticks of every CUDA method are timed at a million points") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sculpture", 1'000'000);
  const auto path = wanderingPath(scene, 2000, 0.5 * scene.radius, 1);
  for (const CudaMethod method : allCudaMethods()) {
    std::vector<double> wall_us, gpu_us;
    for (const bool timeGpu : {false, true}) {
      CudaTouchOptions options = cudaOptions(scene.cloud, scene.radius, method);
      options.timeGpu = timeGpu;
      CudaTouch touch(scene.cloud, options);
      for (const DVec3& hip : path) {
        const Stopwatch watch;
        const Contact contact = touch.query({.hip = hip}, 0);
        if (!timeGpu) wall_us.push_back(watch.elapsed_us());
        if (timeGpu) gpu_us.push_back(contact.gpu_us);
        REQUIRE(contact.valid);
      }
      touch.finish();
    }
    const Summary wall = summarize(wall_us), gpu = summarize(gpu_us);
    CHECK(wall.p50 > 0);
    CHECK(gpu.p50 > 0);
    MESSAGE(nameOf(method) << ": pose to answer " << wall.p50 << " / " << wall.p999 << " us, on the GPU " << gpu.p50
                           << " / " << gpu.p999 << " us (median / p99.9)");
  }
}

}  // namespace palpate::cuda_measure_test
