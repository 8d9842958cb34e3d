// The GPU adds and removes points as engine/edit/resampling.hpp specifies.
#include "tests/edit_gpu/edited_scene.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"

#include <functional>
#include <random>

namespace palpate::resample_gpu_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr double kRadius = 4;
constexpr int kSide = 14;

// A flat sheet of points with a spacing of 1, and `more`.
PointCloud sheetWith(std::initializer_list<Vec3> more) {
  PointCloud cloud;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) cloud.positions.emplace_back(x, y, 0);
  cloud.positions.insert(cloud.positions.end(), more);
  cloud.normals.assign(cloud.positions.size(), Vec3(0, 0, 1));
  return cloud;
}

constexpr BrushOptions kEverything{
    .kind = BrushKind::grab, .yieldDepth = 0, .radius = 1e3, .strength = 1, .falloff = 0};

// Moves all points a little, so that all are examined, then runs ticks until their requests are carried out. Returns
// the number of those ticks.
int shake(EditedScene& scene) {
  const DVec3 hip(0, 0, -1);
  CHECK(scene.brush(hip, DVec3(0, 0, 1), EditedScene::How::incremental, DVec3(0, 0, 0.01)));
  int ticks = 0;
  for (; scene.edit().unsettled() && ticks < 60; ++ticks)
    CHECK(scene.brush(hip, DVec3(0), EditedScene::How::incremental));
  return ticks;
}

// Moves points without examining any.
void put(EditedScene& scene, const std::function<bool(PointState&)>& moved) {
  std::vector<PointChange> changes;
  for (const auto& [id, state] : scene.points()) {
    PointState to = state;
    if (moved(to)) changes.push_back({.from = state, .to = to});
  }
  CHECK(scene.change(changes, EditedScene::How::incremental));
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "in a row of crowded points the second is removed, and the third therefore stays") {
  const auto sheet = static_cast<std::uint32_t>(kSide * kSide), place = static_cast<std::uint32_t>(6 * kSide + 6);
  const PointCloud cloud = sheetWith({{6.5f, 6.5f, 0}, {7.5f, 6.5f, 0}});
  EditedScene scene(device, cloud, makeHashGrid(Vec3(-10), kRadius, cloud.size()), kRadius, kEverything);
  put(scene, [&](PointState& point) {
    if (point.number < sheet) return false;
    point.position = {point.number == sheet ? 6.25f : 6.5f, 6, 0};
    return true;
  });
  CHECK(shake(scene) > 0);
  const auto points = scene.points();
  CHECK(points.contains(place));
  CHECK_FALSE(points.contains(sheet));
  CHECK(points.contains(sheet + 1));
}

TEST_CASE_FIXTURE(GpuFixture, "clouds that were loaded uneven stay so, however often they are examined") {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(0, kSide - 1);
  PointCloud cloud = sheetWith({});
  std::erase_if(cloud.positions, [](const Vec3& p) { return glm::distance(p, Vec3(3, 3, 0)) < 1.8f; });
  for (int k = 0; k < 300; ++k) {
    const Vec3 p{place(random), place(random), 0};
    if (p.x > 9 && p.y > 9) cloud.positions.push_back(p);  // about fifteen times as dense
  }
  cloud.normals.assign(cloud.positions.size(), Vec3(0, 0, 1));
  EditedScene scene(device, cloud, makeHashGrid(Vec3(-10), kRadius, cloud.size()), kRadius, kEverything);
  for (int k = 0; k < 3; ++k) shake(scene);
  const auto points = scene.points();
  CHECK(points.size() == cloud.size());
  CHECK(points.rbegin()->first == cloud.size() - 1);
}

TEST_CASE_FIXTURE(GpuFixture, "a gap torn by an edit closes, and new points keep their distance from all others") {
  const PointCloud cloud = sheetWith({});
  EditedScene scene(device, cloud, makeHashGrid(Vec3(-10), kRadius, cloud.size()), kRadius, kEverything);
  put(scene, [](PointState& point) {
    if (point.position.x < 6.5f) return false;
    point.position.x += 2;
    return true;
  });
  CHECK(shake(scene) < 30);
  const auto points = scene.points();
  CHECK(points.size() > cloud.size() + kSide);
  CHECK(points.size() < cloud.size() + 5 * kSide / 2);
  for (const auto& [id, point] : points) {
    if (id < cloud.size()) continue;
    CHECK(point.position.x > 6);
    CHECK(point.position.x < 9);
    CHECK(point.position.y > -0.1f);
    CHECK(point.position.y < kSide - 0.9f);
    for (const auto& [otherId, other] : points)
      if (otherId != id) CHECK(glm::distance(point.position, other.position) > 0.65f);
  }
}

TEST_SUITE_END();

}  // namespace palpate::resample_gpu_test
