// Points come and go on the GPU as engine/edit/resample_reference.hpp says.
#include "tests/edit/edited_scene.hpp"
#include "tests/gpu_fixture.hpp"

namespace palpate {

namespace {

constexpr double kRadius = 4;
constexpr int kSide = 14;

// A flat sheet of points a spacing of 1 apart, and `more`.
PointCloud sheetWith(std::initializer_list<Vec3> more) {
  PointCloud cloud;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) cloud.positions.emplace_back(x, y, 0);
  cloud.positions.insert(cloud.positions.end(), more);
  cloud.normals.assign(cloud.positions.size(), Vec3(0, 0, 1));
  return cloud;
}

// Moves everything a little, so that all points are looked at, and then lets their wishes come to pass.
void shake(EditedScene& scene) {
  const DVec3 hip(0, 0, -1);
  CHECK(scene.brush(hip, DVec3(0, 0, 1), EditedScene::How::incremental, DVec3(0, 0, 0.01)));
  CHECK(scene.edit().unsettled());
  CHECK(scene.brush(hip, DVec3(0), EditedScene::How::incremental));
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "in a row of crowded points the second goes, and the third stays for that") {
  const auto sheet = static_cast<std::uint32_t>(kSide * kSide), place = static_cast<std::uint32_t>(6 * kSide + 6);
  const PointCloud cloud = sheetWith({{6.25f, 6, 0}, {6.5f, 6, 0}});
  EditedScene scene(device, cloud, makeHashGrid(Vec3(-10), kRadius, cloud.size()), kRadius,
                    {.kind = BrushKind::grab, .tau = 0, .toolRadius = 1e3, .strength = 1, .falloff = 0});
  shake(scene);
  const auto points = scene.points();
  CHECK(points.contains(place));
  CHECK_FALSE(points.contains(sheet));
  CHECK(points.contains(sheet + 1));
}

}  // namespace palpate
