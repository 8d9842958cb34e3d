// Fusion on the GPU against fusion on the host: the same frames give the same points.
#include "engine/motion/fusion_pass.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/cloud/point_tree.hpp"
#include "engine/core/error.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/motion_gpu/fused_cloud.hpp"

namespace palpate::fusion_pass_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

const DVec3 kTable(0, 0, 0.02);

// Points of a map by id, in the format of FusedCloud.
std::vector<shared::Surfel> surfelsOf(const SurfelMap& map, std::size_t slots) {
  std::vector<shared::Surfel> surfels(slots);
  for (std::size_t id = 0; id < map.ids(); ++id)
    if (map.holds(id)) surfels[id] = map.surfel(id);
  return surfels;
}

std::vector<Vec3> placesOf(const std::vector<shared::Surfel>& surfels) {
  std::vector<Vec3> places;
  for (const shared::Surfel& surfel : surfels)
    if (surfel.record.weight > 0) places.push_back(surfel.place);
  return places;
}

// Whether two maps are equal point by point: the same records, and positions up to rounding.
bool haveSamePoints(const std::vector<shared::Surfel>& a, const std::vector<shared::Surfel>& b) {
  return std::ranges::equal(a, b, [](const shared::Surfel& x, const shared::Surfel& y) {
    if ((x.record.weight > 0) != (y.record.weight > 0)) return false;
    return x.record.weight == 0 || (x.record.counts == y.record.counts && x.record.seen == y.record.seen &&
                                    x.record.color == y.record.color && glm::distance(x.place, y.place) < 1e-6f);
  });
}

// Whether nearly all points of one map are near a point of the other.
bool lieTogether(const std::vector<shared::Surfel>& a, const std::vector<shared::Surfel>& b) {
  const std::vector<Vec3> from = placesOf(a), to = placesOf(b);
  if (to.empty()) return from.empty();
  const PointTree tree(to);
  std::size_t near = 0;
  for (const Vec3& place : from) {
    std::array<std::uint32_t, 1> index{};
    std::array<double, 1> square{};
    tree.nearest(place, index, square);
    near += square[0] < 1e-6 ? 1 : 0;
  }
  return static_cast<double>(near) > 0.99 * static_cast<double>(from.size());
}

// A driver on the CPU rounds every operation as the host does. One on a GPU may divide and contract differently; then a
// point on the border of a gate may fall to the other side, and all later new points have other ids.
class FusionFixture : public GpuFixture {
 protected:
  void checkAlike(const FusionCounts& counts, const FusionCounts& expected) const {
    if (device.isCpu()) {
      CHECK(counts == expected);
      return;
    }
    const auto near = [](std::uint64_t is, std::uint64_t shouldBe) {
      const double apart = std::abs(static_cast<double>(is) - static_cast<double>(shouldBe));
      return apart <= 20 + 0.005 * static_cast<double>(shouldBe);
    };
    CHECK(near(counts.points, expected.points));
    CHECK(near(counts.matched, expected.matched));
    CHECK(near(counts.appended, expected.appended));
    CHECK(near(counts.removed, expected.removed));
    CHECK(near(counts.refused, expected.refused));
  }
  void checkAlike(const FusedCloud& gpu, const SurfelMap& map) const {
    const auto is = gpu.surfels(), shouldBe = surfelsOf(map, is.size());
    if (device.isCpu()) CHECK(haveSamePoints(is, shouldBe));
    CHECK(lieTogether(is, shouldBe));
    CHECK(lieTogether(shouldBe, is));
  }
};

}  // namespace

TEST_CASE_FIXTURE(FusionFixture, "fusion on the GPU gives the map of the host, frame after frame") {
  const FusionOptions options = smallMap(60'000);
  const DepthScene scene = tableScene();
  FrameFusion host(options);
  FusedCloud gpu(device, smallCamera(), options);
  for (std::uint64_t i = 0; i < 6; ++i) {
    CAPTURE(i);
    DepthFrame frame = scene.frame(smallCamera(), onArc(kTable, 1.0, 0.3 + 0.05 * static_cast<double>(i)), 1, i);
    if (i != 3)
      for (std::size_t pixel = 0; pixel < frame.depth_m.size(); ++pixel)
        frame.colors.push_back({static_cast<std::uint8_t>(pixel), static_cast<std::uint8_t>(pixel / 256), 7});
    const FusionCounts expected = host.fuse(smallCamera(), frame).counts;
    checkAlike(gpu.fuse(smallCamera(), frame), expected);
    checkAlike(gpu, host.map());
  }
}

TEST_CASE_FIXTURE(FusionFixture,
                  "GPU fusion removes ghosts, reuses their ids and reports a full map, as the host does") {
  DepthScene before, after;
  before.add("plane", 0.8, DVec3(0)).add("sphere", 0.08, DVec3(-0.05, 0, 0.06));
  after.add("plane", 0.8, DVec3(0)).add("sphere", 0.08, DVec3(0.05, 0, 0.06));
  const CameraPose pose = onArc(kTable, 1.0, 0.5);
  for (const std::size_t capacity : {60'000u, 20'001u}) {
    CAPTURE(capacity);
    FrameFusion host(smallMap(capacity));
    FusedCloud gpu(device, smallCamera(), smallMap(capacity));
    for (std::uint64_t i = 0; i < 11; ++i) {
      const DepthFrame frame = (i < 5 ? before : after).frame(smallCamera(), pose, 1, i);
      const FusionCounts expected = host.fuse(smallCamera(), frame).counts;
      checkAlike(gpu.fuse(smallCamera(), frame), expected);
    }
    CHECK(host.map().totals().removed > 500);
    CHECK((host.map().totals().refused > 0) == (capacity == 20'001));
    checkAlike(gpu, host.map());
  }
}

TEST_CASE_FIXTURE(FusionFixture,
                  "GPU fusion handles depth images of any size, with and without depth, as the host does") {
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
      const FusionCounts expected = host.fuse(camera, frame).counts;
      checkAlike(gpu.fuse(camera, frame), expected);
    }
    checkAlike(gpu, host.map());
  }
}

TEST_CASE_FIXTURE(FusionFixture, "the same frames give the same map bit by bit, and points out of view do not change") {
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
  std::size_t kept = 0, changed = 0, come = 0;
  for (std::size_t id = 0; id < a.size(); ++id) {
    if (a[id].record.weight > 0)
      areSame(a[id], after[id]) ? ++kept : ++changed;
    else
      come += after[id].record.weight > 0 ? 1 : 0;
  }
  CHECK(kept > 15'000);
  CHECK(changed == 0);
  CHECK(come > 10'000);
}

TEST_CASE_FIXTURE(FusionFixture, "fusion continues an existing cloud, keeps its colours and does not reuse its ids") {
  const auto plane = makeShape("plane", 0.3);
  PointCloud begun = sampleShape(*plane, {.count = 5000, .seed = 3});
  begun.colors.assign(begun.size(), {250, 7, 80, 255});
  FusedCloud gpu(device, smallCamera(), smallMap(40'000), begun);
  DepthScene scene;
  scene.add("plane", 3, {0, 0, 0.001});
  const CameraPose pose = lookingAt({0, 0, 1}, {0, 0, 0});
  FusionCounts counts;
  for (std::uint64_t i = 0; i < 3; ++i) counts = gpu.fuse(smallCamera(), scene.frame(smallCamera(), pose, 0, i));
  CHECK(counts.matched > 15'000);
  const auto surfels = gpu.surfels();
  std::size_t raised = 0;
  float furthest = 0;
  for (std::size_t id = 0; id < begun.size(); ++id) {
    REQUIRE(surfels[id].record.weight > 0);
    furthest = std::max(furthest, glm::distance(Vec2(surfels[id].place), Vec2(begun.positions[id])));
    raised += surfels[id].place.z > 0.0001f ? 1 : 0;
    CHECK(colorOf(surfels[id].record) == std::array<std::uint8_t, 3>{250, 7, 80});
  }
  CHECK(raised > 3000);
  CHECK(furthest < 0.001f);
}

TEST_CASE_FIXTURE(FusionFixture, "points moved or removed by a brush stay so out of view, and their ids are kept") {
  const FusionOptions options = smallMap(20'000);
  const DepthScene scene = tableScene();
  FusedCloud gpu(device, smallCamera(), options);
  gpu.fuse(smallCamera(), scene.frame(smallCamera(), onArc(kTable, 1.0, 0.5), 0, 0));
  // The slots of the front half as an edit leaves them: one point moved, another one removed.
  std::vector<Vec4> positions = download<Vec4>(device, gpu.cloud().front().positions, gpu.cloud().slots());
  const auto idOf = [&](std::size_t slot) { return std::bit_cast<std::uint32_t>(positions[slot].w); };
  const std::uint32_t moved = idOf(10), taken = idOf(20);
  REQUIRE(moved != shared::kEmptySlot);
  REQUIRE(taken != shared::kEmptySlot);
  positions[10] = Vec4(0.01f, 0.02f, 1.5f, positions[10].w);
  positions[20].w = std::bit_cast<float>(shared::kEmptySlot);
  upload(device, gpu.cloud().front().positions, positions);
  DepthScene ceiling;
  ceiling.add("plane", 3, {0, 0, 4});
  const CameraPose away = lookingAt({0, 0, 2}, {0, 0, 4});
  const FusionCounts counts = gpu.fuse(smallCamera(), ceiling.frame(smallCamera(), away, 0, 1));
  CHECK(counts.refused > 0);  // the map is full, but the id of the removed point is not reused
  const auto surfels = gpu.surfels();
  CHECK(surfels[moved].place == Vec3(0.01f, 0.02f, 1.5f));
  CHECK(surfels[taken].record.weight == 0);
  CHECK(counts.points == options.capacity - 1);
}

TEST_CASE_FIXTURE(FusionFixture, "parameters of a fusion that do not fit are refused before memory is allocated") {
  const auto refuses = [&](const DepthCamera& camera, const FusionOptions& options, std::uint32_t slots) {
    CHECK_THROWS_AS(FusionPass(device, camera, options, slots), Error);
  };
  refuses(smallCamera(), smallMap(1000), 999);
  refuses({}, smallMap(1000), 1000);
  FusionOptions none = smallMap(0);
  refuses(smallCamera(), none, 1000);
}

TEST_SUITE_END();

}  // namespace palpate::fusion_pass_test
