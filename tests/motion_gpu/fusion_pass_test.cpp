// Fusion on the GPU against the one on the host: the same frames, the same points.
#include "engine/motion/fusion_pass.hpp"

#include <algorithm>

#include "engine/core/error.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/motion_gpu/fused_cloud.hpp"

namespace palpate {

namespace {

const DVec3 kTable(0, 0, 0.02);

// How far the two maps are apart, point by point.
struct Difference {
  std::size_t points = 0;   // in both
  std::size_t unequal = 0;  // in one of them, or with another history
  double furthest_mm = 0;
};

Difference between(const SurfelMap& map, const std::vector<shared::Surfel>& surfels) {
  Difference difference;
  for (std::size_t id = 0; id < surfels.size(); ++id) {
    const bool here = id < map.ids() && map.holds(id), there = surfels[id].record.weight > 0;
    if (!here && !there) continue;
    if (here != there || map.surfel(id).record.counts != surfels[id].record.counts ||
        map.surfel(id).record.seen != surfels[id].record.seen) {
      ++difference.unequal;
      continue;
    }
    ++difference.points;
    difference.furthest_mm =
        std::max(difference.furthest_mm, 1000 * glm::distance(DVec3(map.surfel(id).place), DVec3(surfels[id].place)));
  }
  return difference;
}

class FusionFixture : public GpuFixture {};

}  // namespace

TEST_CASE_FIXTURE(FusionFixture, "the map on the GPU is the one on the host, frame after frame") {
  const FusionOptions options = smallMap(60'000);
  const DepthScene scene = tableScene();
  FrameFusion host(options);
  FusedCloud gpu(device, smallCamera(), options);
  for (std::uint64_t i = 0; i < 8; ++i) {
    CAPTURE(i);
    DepthFrame frame = scene.frame(smallCamera(), onArc(kTable, 1.0, 0.3 + 0.05 * static_cast<double>(i)), 1, i);
    if (i != 3)
      for (std::size_t pixel = 0; pixel < frame.depth_m.size(); ++pixel)
        frame.colors.push_back({static_cast<std::uint8_t>(pixel), static_cast<std::uint8_t>(pixel / 256), 7});
    const FusionCounts expected = host.fuse(smallCamera(), frame).counts;
    const FusionCounts counts = gpu.fuse(smallCamera(), frame);
    CHECK(counts == expected);
    const Difference difference = between(host.map(), gpu.surfels());
    CHECK(difference.points == host.map().count());
    CHECK(difference.unequal == 0);
    CHECK(difference.furthest_mm < 1e-3);
  }
  const auto surfels = gpu.surfels();
  std::size_t colors = 0;
  for (std::size_t id = 0; id < host.map().ids(); ++id)
    colors += host.map().holds(id) && host.map().surfel(id).record.color == surfels[id].record.color;
  CHECK(colors == host.map().count());
}

TEST_CASE_FIXTURE(FusionFixture, "on the GPU, too, a ghost goes, its ids come again, and a full map says so") {
  DepthScene before, after;
  before.add("plane", 0.8, DVec3(0)).add("sphere", 0.08, DVec3(-0.05, 0, 0.06));
  after.add("plane", 0.8, DVec3(0)).add("sphere", 0.08, DVec3(0.05, 0, 0.06));
  const CameraPose pose = onArc(kTable, 1.0, 0.5);
  for (const std::size_t capacity : {60'000u, 20'001u}) {
    CAPTURE(capacity);
    FrameFusion host(smallMap(capacity));
    FusedCloud gpu(device, smallCamera(), smallMap(capacity));
    for (std::uint64_t i = 0; i < 14; ++i) {
      const DepthFrame frame = (i < 6 ? before : after).frame(smallCamera(), pose, 1, i);
      const FusionCounts expected = host.fuse(smallCamera(), frame).counts;
      CHECK(gpu.fuse(smallCamera(), frame) == expected);
    }
    CHECK(host.map().totals().removed > 500);
    CHECK((host.map().totals().refused > 0) == (capacity == 20'001));
    const Difference difference = between(host.map(), gpu.surfels());
    CHECK(difference.points == host.map().count());
    CHECK(difference.unequal == 0);
  }
}

TEST_CASE_FIXTURE(FusionFixture, "images of any size, without depth and with it, are the same on the GPU") {
  for (const auto& [width, height] : {std::pair(1u, 1u), {17u, 3u}, {33u, 31u}, {257u, 9u}}) {
    CAPTURE(width);
    const DepthCamera camera{
        .width = width, .height = height, .fx = 500, .fy = 500, .cx = 0.5 * (width - 1), .cy = 0.5 * (height - 1)};
    FrameFusion host(smallMap(3000));
    FusedCloud gpu(device, camera, smallMap(3000));
    for (const float depth : {0.0f, 1.0f, 1.001f, 0.0f, 2.0f, 0.5f}) {
      DepthFrame frame;
      frame.depth_m.assign(std::size_t{width} * height, depth);
      frame.pose = CameraPose{};
      CHECK(gpu.fuse(camera, frame) == host.fuse(camera, frame).counts);
    }
    CHECK(between(host.map(), gpu.surfels()).unequal == 0);
  }
}

TEST_CASE_FIXTURE(FusionFixture, "the same frames give the same bytes, and points out of view keep theirs") {
  const FusionOptions options = smallMap(40'000);
  const DepthScene scene = tableScene();
  FusedCloud one(device, smallCamera(), options), other(device, smallCamera(), options);
  for (std::uint64_t i = 0; i < 4; ++i) {
    const DepthFrame frame = scene.frame(smallCamera(), onArc(kTable, 1.0, 0.2 * static_cast<double>(i)), 1, i);
    one.fuse(smallCamera(), frame);
    other.fuse(smallCamera(), frame);
  }
  const auto a = one.surfels(), b = other.surfels();
  CHECK(std::ranges::equal(a, b, [](const auto& x, const auto& y) { return areSame(x, y); }));
  DepthScene ceiling;
  ceiling.add("plane", 3, {0, 0, 2});
  one.fuse(smallCamera(), ceiling.frame(smallCamera(), lookingAt({0, 0, 1}, {0, 0, 2}), 1, 9));
  const auto after = one.surfels();
  std::size_t kept = 0, come = 0;
  for (std::size_t id = 0; id < a.size(); ++id) {
    if (a[id].record.weight > 0) {
      REQUIRE(areSame(a[id], after[id]));
      ++kept;
    } else {
      come += after[id].record.weight > 0 ? 1 : 0;
    }
  }
  CHECK(kept > 15'000);
  CHECK(come > 10'000);
}

TEST_CASE_FIXTURE(FusionFixture, "a cloud that is there is gone on with, and its ids are not given away") {
  const auto plane = makeShape("plane", 0.3);
  const PointCloud begun = sampleShape(*plane, {.count = 5000, .seed = 3});
  FusedCloud gpu(device, smallCamera(), smallMap(40'000), begun);
  DepthScene scene;
  scene.add("plane", 3, {0, 0, 0.001});
  const CameraPose pose = lookingAt({0, 0, 1}, {0, 0, 0});
  FusionCounts counts;
  for (std::uint64_t i = 0; i < 3; ++i) counts = gpu.fuse(smallCamera(), scene.frame(smallCamera(), pose, 0, i));
  CHECK(counts.matched > 15'000);
  const auto surfels = gpu.surfels();
  std::size_t raised = 0;
  for (std::size_t id = 0; id < begun.size(); ++id) {
    REQUIRE(surfels[id].record.weight > 0);
    CHECK(glm::distance(Vec2(surfels[id].place), Vec2(begun.positions[id])) < 0.001f);
    raised += surfels[id].place.z > 0.0001f ? 1 : 0;
  }
  CHECK(raised > 3000);
}

TEST_CASE_FIXTURE(FusionFixture, "what does not fit is refused before any memory is taken") {
  const auto refuses = [&](const DepthCamera& camera, const FusionOptions& options, std::uint32_t slots) {
    CHECK_THROWS_AS(FusionPass(device, camera, options, slots), Error);
  };
  refuses(smallCamera(), smallMap(1000), 999);
  refuses({}, smallMap(1000), 1000);
  FusionOptions none = smallMap(0);
  refuses(smallCamera(), none, 1000);
}

}  // namespace palpate
