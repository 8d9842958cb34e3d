#include "engine/cuda/cuda_measure.hpp"

#include <algorithm>

#include "engine/core/statistics.hpp"
#include "tests/cuda/cuda_fixture.hpp"

namespace palpate {

TEST_CASE("CUB's sort is timed once per repetition") {
  NEEDS_CUDA_DEVICE();
  std::mt19937 random(1);
  for (const std::size_t count : {1, 1000, 1'000'000}) {
    std::vector<std::uint32_t> keys(count);
    for (auto& key : keys) key = random();
    for (const unsigned bits : {18u, 32u}) {
      const CubSortTimes times = timeCubSort(keys, bits, 30);
      CHECK(times.size() == 30);
      CHECK(std::ranges::all_of(times, [](double time_us) { return time_us > 0 && time_us < 1e6; }));
      MESSAGE("sort of " << count << " pairs by " << bits << " bits: " << summarize(times).p50 << " us");
    }
  }
}

TEST_CASE("CUB's build is timed from the cloud's own order, then from the last build's") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sculpture", 1'000'000);
  const HashGrid grid = makeHashGrid(Vec3(boundsOf(scene.cloud).min), scene.radius, scene.cloud.size());
  for (const double movedShare : {0.0, 0.01}) {
    const CubBuildTimes times = timeCubBuild(scene.cloud, grid, 50, movedShare);
    CHECK(times.first_us > 0);
    CHECK(times.steady_us.size() == 50);
    CHECK(std::ranges::all_of(times.steady_us, [](double time_us) { return time_us > 0 && time_us < 1e6; }));
    MESSAGE("build of " << scene.cloud.size() << " points, share moved " << movedShare << ": first " << times.first_us
                        << " us, steady " << summarize(times.steady_us).p50 << " us");
  }
}

}  // namespace palpate
