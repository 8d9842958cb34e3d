#include "engine/cuda/cub_hash_build.hpp"

#include <bit>

#include "engine/cuda/live_copy.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "tests/cuda/cuda_fixture.hpp"
#include "tests/random_positions.hpp"

namespace palpate::cub_hash_build_test {

namespace {

PointCloud cloudOf(std::vector<Vec3> positions) {
  PointCloud cloud;
  cloud.positions = std::move(positions);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    cloud.normals.push_back(glm::normalize(Vec3(static_cast<float>(i % 7), static_cast<float>(i % 5), 1)));
  return cloud;
}

void checkHalf(const cu::Stream& stream, cu::LiveCopy& live, const cu::CubBuild& build, const SortedGrid& reference,
               const PointCloud& cloud) {
  const cu::CloudHalf& half = live.half(live.parity());
  const auto positions = half.positions.download(stream);
  const auto normals = half.normals.download(stream);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::uint32_t id = reference.placed()[i].number;
    wrong += std::bit_cast<std::uint32_t>(positions[i].w) != id || Vec3(positions[i]) != cloud.positions[id] ||
             Vec3(normals[i]) != cloud.normals[id];
  }
  CHECK(wrong == 0);
  const auto ranges = build.ranges().download(stream);
  std::size_t wrongRanges = 0;
  for (std::uint32_t bucket = 0; bucket < ranges.size(); ++bucket) {
    const UVec2 expected = reference.range(bucket);
    const bool empty = expected.x == expected.y;
    wrongRanges += empty ? ranges[bucket].x != ranges[bucket].y : ranges[bucket] != expected;
  }
  CHECK(wrongRanges == 0);
}

// Order, ranges and attributes equal those of the CPU after a first build, a second one, and one from a graph.
void checkBuild(const PointCloud& cloud, const HashGrid& grid) {
  SortedGrid reference(grid, 1);
  reference.build(cloud.positions);
  const cu::Stream stream;
  cu::LiveCopy live(cloud, stream);
  cu::CubBuild build(grid, live.count());
  const auto record = [&] {
    build.record(stream, live.half(live.parity()), live.half(1 - live.parity()), live.count());
  };
  for (int turn = 0; turn < 3; ++turn) {
    if (turn < 2)
      record();
    else
      cu::Graph(stream, record).launch(stream), stream.synchronize("building from a graph");
    live.flip();
    checkHalf(stream, live, build, reference, cloud);
  }
}

}  // namespace

TEST_CASE("the CUB build has the order and ranges of the reference at counts around block sizes") {
  NEEDS_CUDA_DEVICE();
  for (const std::size_t count : {0, 1, 2, 255, 256, 257, 4095, 4096, 4097, 65'537, 1'000'003}) {
    CAPTURE(count);
    checkBuild(cloudOf(randomPositions(count, Vec3(0), 50)), makeHashGrid(Vec3(-50), 1.5, count));
  }
}

TEST_CASE("the CUB build handles cells in Morton order and coincident points") {
  NEEDS_CUDA_DEVICE();
  checkBuild(cloudOf(randomPositions(100'000, Vec3(0), 50)), makeHashGrid(Vec3(-50), 1, 100'000, BucketKey::morton));
  checkBuild(cloudOf(std::vector<Vec3>(10'007, Vec3(3, -4, 5))), makeHashGrid(Vec3(0), 1, 10'007));
}

TEST_CASE("the CUB build handles negative and far coordinates and outliers beyond every cell") {
  NEEDS_CUDA_DEVICE();
  checkBuild(cloudOf(randomPositions(5000, Vec3(-1e6f, 2e6f, -3e6f), 100)), makeHashGrid(Vec3(0), 2, 5000));
  checkBuild(cloudOf(randomPositions(5000, Vec3(-40, -40, -40), 10)), makeHashGrid(Vec3(0), 0.7, 5000));
  auto positions = randomPositions(20'000, Vec3(0), 1);
  positions.push_back(Vec3(1e6f, -1e6f, 1e6f));
  positions.push_back(Vec3(3e38f, -3e38f, 3e38f));
  const HashGrid grid = makeHashGrid(Vec3(0), 0.1, positions.size());
  checkBuild(cloudOf(std::move(positions)), grid);
}

}  // namespace palpate::cub_hash_build_test
