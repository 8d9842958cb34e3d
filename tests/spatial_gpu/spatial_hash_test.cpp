#include "engine/spatial/spatial_hash.hpp"

#include <algorithm>
#include <set>

#include "engine/gpu/transfer.hpp"
#include "engine/spatial/look_back_sort.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/random_positions.hpp"
#include "tests/scenes.hpp"

namespace palpate::spatial_hash_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

PointCloud cloudOf(std::vector<Vec3> positions) {
  PointCloud cloud;
  cloud.normals.assign(positions.size(), Vec3(0, 0, 1));
  cloud.positions = std::move(positions);
  return cloud;
}

class SpatialHashFixture : public GpuFixture {
 protected:
  static constexpr std::array kSorts{SortMethod::radix, SortMethod::counting, SortMethod::radixLookBack};

  // Order, ranges and attributes on the GPU equal those of the CPU, after a first and a second build, for every sort
  // and both kinds of buckets.
  void checkBuild(const PointCloud& cloud, HashGrid grid) {
    for (const std::uint32_t blockBits : {0u, 3u}) {
      grid.blockBits = blockBits;
      SortedGrid reference(grid, 1);
      reference.build(cloud.positions);
      std::vector<std::uint32_t> order;
      for (const SortedGrid::Placed& point : reference.placed()) order.push_back(point.number);
      for (const SortMethod sort : kSorts) {
        CAPTURE(static_cast<int>(sort));
        LiveCloud live(device, cloud);
        SpatialHash hash(device, grid, live.count(), sort);
        for (int turn = 0; turn < 2; ++turn) {  // a build of a cloud in bucket order may not change it
          hash.build(live);
          checkHalf(live, hash, reference, cloud, order);
        }
      }
    }
  }

 private:
  void checkHalf(const LiveCloud& live, const SpatialHash& hash, const SortedGrid& reference, const PointCloud& cloud,
                 const std::vector<std::uint32_t>& order) {
    const auto positions = download<Vec4>(device, live.front().positions, live.count());
    const auto normals = download<Vec4>(device, live.front().normals, live.count());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const std::uint32_t id = order[i];
      wrong += std::bit_cast<std::uint32_t>(positions[i].w) != id || Vec3(positions[i]) != cloud.positions[id] ||
               Vec3(normals[i]) != cloud.normals[id];
    }
    CHECK(wrong == 0);
    const auto ranges = download<UVec2>(device, hash.ranges(live.front()), std::size_t{hash.grid().bucketMask} + 1);
    std::size_t wrongRanges = 0;
    for (std::uint32_t bucket = 0; bucket < ranges.size(); ++bucket) {
      const UVec2 expected = reference.range(bucket);
      const bool empty = expected.x == expected.y;
      wrongRanges += empty ? ranges[bucket].x != ranges[bucket].y : ranges[bucket] != expected;
    }
    CHECK(wrongRanges == 0);
  }
};

}  // namespace

TEST_CASE_FIXTURE(SpatialHashFixture,
                  "the spatial hash has the order and ranges of the reference at counts around block sizes") {
  for (const std::size_t count : {0, 1, 2, 255, 256, 257, 4095, 4096, 4097, 65'537}) {
    CAPTURE(count);
    checkBuild(cloudOf(randomPositions(count, Vec3(0), 50)), makeHashGrid(Vec3(-50), 1.5, count));
  }
}

TEST_CASE_FIXTURE(SpatialHashFixture,
                  "the spatial hash of many points, in the full tier a million, equals the reference" * kMoreInFull) {
  const std::size_t count = byTier<std::size_t>(300'007, 1'000'003);
  checkBuild(cloudOf(randomPositions(count, Vec3(0), 50)), makeHashGrid(Vec3(-50), 0.5, count));
}

TEST_CASE_FIXTURE(SpatialHashFixture, "the spatial hash of coincident points is one bucket, in order") {
  checkBuild(cloudOf(std::vector<Vec3>(10'007, Vec3(3, -4, 5))), makeHashGrid(Vec3(0), 1, 10'007));
}

TEST_CASE_FIXTURE(SpatialHashFixture, "the spatial hash handles a line, a plane along the axes and triplicate points") {
  std::vector<Vec3> line, plane, thrice;
  for (int i = 0; i < 20'000; ++i) line.emplace_back(0.01f * static_cast<float>(i), 0, 0);
  for (int i = 0; i < 20'000; ++i)
    plane.emplace_back(0.3f * static_cast<float>(i % 141), 0.3f * static_cast<float>(i / 141), 0);
  for (const Vec3& position : randomPositions(5000, Vec3(0), 20)) thrice.insert(thrice.end(), 3, position);
  for (const auto& positions : {line, plane, thrice})
    checkBuild(cloudOf(positions), makeHashGrid(Vec3(-50), 1.5, positions.size()));
}

TEST_CASE_FIXTURE(SpatialHashFixture, "the spatial hash handles negative and far coordinates") {
  checkBuild(cloudOf(randomPositions(5000, Vec3(-1e6f, 2e6f, -3e6f), 100)), makeHashGrid(Vec3(0), 2, 5000));
  checkBuild(cloudOf(randomPositions(5000, Vec3(-40, -40, -40), 10)), makeHashGrid(Vec3(0), 0.7, 5000));
}

TEST_CASE_FIXTURE(SpatialHashFixture,
                  "one outlier a million units away takes no memory and does not disturb the spatial hash") {
  auto positions = randomPositions(20'000, Vec3(0), 1);
  positions.push_back(Vec3(1e6f, -1e6f, 1e6f));
  positions.push_back(Vec3(3e38f, -3e38f, 3e38f));  // beyond every cell: clamped to the border
  const auto cloud = cloudOf(positions);
  const HashGrid grid = makeHashGrid(Vec3(0), 0.1, cloud.size());
  const SpatialHash hash(device, grid, static_cast<std::uint32_t>(cloud.size()));
  CHECK(hash.bytes() < 40 * cloud.size() + (1 << 16));
  checkBuild(cloud, grid);
}

TEST_CASE_FIXTURE(SpatialHashFixture, "in arrival order every bucket contains the same complete points") {
  const auto cloud = cloudOf(randomPositions(65'537, Vec3(0), 50));
  const HashGrid grid = makeHashGrid(Vec3(-50), 1.5, cloud.size());
  SortedGrid reference(grid, 1);
  reference.build(cloud.positions);
  LiveCloud live(device, cloud);
  SpatialHash hash(device, grid, live.count(), SortMethod::counting, BucketOrder::arrival);
  for (int turn = 0; turn < 2; ++turn) {
    hash.build(live);
    const auto positions = download<Vec4>(device, live.front().positions, live.count());
    const auto ranges = download<UVec2>(device, hash.ranges(live.front()), std::size_t{grid.bucketMask} + 1);
    std::size_t wrong = 0;
    for (std::uint32_t bucket = 0; bucket < ranges.size(); ++bucket) {
      const UVec2 expected = reference.range(bucket);
      wrong += ranges[bucket] != expected && expected.x != expected.y;
      std::vector<std::uint32_t> ids;
      for (std::uint32_t i = expected.x; i < expected.y; ++i) {
        ids.push_back(std::bit_cast<std::uint32_t>(positions[i].w));
        wrong += Vec3(positions[i]) != cloud.positions.at(ids.back());
      }
      std::ranges::sort(ids);
      wrong += !std::ranges::equal(ids, reference.placed().subspan(expected.x, expected.y - expected.x), {}, {},
                                   &SortedGrid::Placed::number);
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE_FIXTURE(SpatialHashFixture, "many points in random order are sorted with look-back where that is faster") {
  std::vector<Vec3> positions(2'000'000);
  std::uint32_t state = 1;
  for (Vec3& p : positions)
    for (int k = 0; k < 3; ++k) p[k] = static_cast<float>((state = state * 1664525u + 1013904223u) >> 8) / 16777216.0f;
  const HashGrid grid = makeHashGrid(Vec3(0), 0.01, positions.size());
  const bool faster = prefersLookBack(device) && LookBackSort::fits(device, bucketBits(grid) + 1);
  CHECK(sortInOrder(device, grid, positions, Slots::spare) ==
        (faster ? SortMethod::radixLookBack : SortMethod::counting));
  CHECK(sortInOrder(device, grid, std::span(positions).first(1000), Slots::spare) == SortMethod::counting);
  std::ranges::sort(positions, {}, [&](const Vec3& p) { return bucketOf(grid, cellOf(grid, p)); });
  CHECK(sortInOrder(device, grid, positions, Slots::spare) == SortMethod::counting);
}

TEST_CASE_FIXTURE(SpatialHashFixture, "counting sort is replaced by a radix sort only if a bucket is crowded") {
  const auto crowd = [&](std::size_t together) {
    auto positions = randomPositions(3000, Vec3(0), 40);
    positions.resize(positions.size() + together, Vec3(100, 100, 100));
    const auto cloud = cloudOf(positions);
    const HashGrid grid = makeHashGrid(Vec3(-50), 1.5, cloud.size());
    LiveCloud live(device, cloud);
    SpatialHash hash(device, grid, live.count(), SortMethod::counting);
    hash.build(live);
    return hash.sort();
  };
  CHECK(crowd(shared::kCrowdedBucket / 2) == SortMethod::counting);
  CHECK(crowd(shared::kCrowdedBucket + 1) != SortMethod::counting);
}

TEST_SUITE_END();

}  // namespace palpate::spatial_hash_test
