#include "engine/edit/edit_pass.hpp"

#include <algorithm>
#include <bit>
#include <set>

#include "engine/edit/normal_fit.hpp"
#include "engine/edit/placed_brush.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "shaders/shared/edit.h"
#include "tests/edit_gpu/edited_scene.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"

namespace palpate::edit_pass_test {

namespace {

class EditFixture : public GpuFixture {
 public:
  using GpuFixture::GpuFixture;

 protected:
  struct Moved {
    std::vector<Vec4> positions, normals;  // in id order
    std::vector<PointState> entries;       // in the order of the log
  };

  // One edited tick for a given contact state, by index update and by full build, which must agree.
  Moved push(const PointCloud& cloud, const DVec3& hip, const DVec3& spring, const BrushOptions& options,
             double radius) {
    const Moved updated = push(cloud, hip, spring, options, radius, EditedScene::How::incremental);
    const Moved rebuilt = push(cloud, hip, spring, options, radius, EditedScene::How::rebuild);
    CHECK(updated.positions == rebuilt.positions);
    CHECK(updated.entries.size() == rebuilt.entries.size());
    double worst_deg = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      worst_deg = std::max(worst_deg, angleBetween_deg(DVec3(updated.normals[i]), DVec3(rebuilt.normals[i])));
    CHECK(worst_deg < 0.1);  // they sum in different order
    return updated;
  }

  Moved push(const PointCloud& cloud, const DVec3& hip, const DVec3& spring, const BrushOptions& options, double radius,
             EditedScene::How how) {
    EditedScene scene(device, cloud, makeHashGrid(Vec3(0), radius, cloud.size()), radius, options);
    if (!scene.brush(hip, spring, how)) {
      how = EditedScene::How::rebuildAll;
      CHECK(scene.brush(hip, spring, how));
    }
    CHECK(scene.faults() == 0);
    Moved moved;
    for (const auto& [id, point] : scene.points()) {
      moved.positions.emplace_back(point.position, std::bit_cast<float>(id));
      moved.normals.emplace_back(point.normal, 0.0f);
    }
    moved.entries = scene.takeLog();
    return moved;
  }
};

}  // namespace

TEST_CASE_FIXTURE(CoreValidated<EditFixture>,
                  "a push moves points in range as the reference does and leaves the others bit by bit") {
  const Scene scene = makeScene("sphere", 20'000);
  const DVec3 outward = glm::normalize(DVec3(1, 2, 2));
  for (const BrushOptions& options : {BrushOptions{.yieldDepth = 0.5, .pushRate = 0.1, .radius = 6},
                                      BrushOptions{.yieldDepth = 0.5, .pushRate = 0.1, .radius = 6, .resample = false},
                                      BrushOptions{.yieldDepth = 0, .pushRate = 1, .radius = 12}}) {
    const DVec3 hip = 47.0 * outward, spring = 3.0 * outward;
    const PlacedBrush brush = brushAt(options, scene.radius, hip, spring);
    const Moved moved = push(scene.cloud, hip, spring, options, scene.radius);
    // In its first tick a point has not looked ahead yet.
    const double room = static_cast<double>(shared::kFirstStep) * scene.radius;
    std::size_t count = 0;
    for (std::size_t i = 0; i < scene.cloud.size(); ++i) {
      const DVec3 before(scene.cloud.positions[i]), normal(scene.cloud.normals[i]);
      const DVec3 expected = brush.brushed(before, normal, {before, normal, room}).position;
      if (expected == before) {
        // Points within rounding of the brush's border may move or not, by less than that.
        CHECK(glm::distance(DVec3(moved.positions[i]), before) < 1e-4);
        continue;
      }
      ++count;
      CHECK(glm::distance(DVec3(moved.positions[i]), expected) < 1e-4);
    }
    CHECK(count > 40);
    CHECK(moved.entries.size() >= count);
    CHECK(moved.entries.size() < count + 5);
  }
}

TEST_CASE_FIXTURE(EditFixture, "the edit log contains exactly the moved points, once each, with their present state") {
  const Scene scene = makeScene("torus", 20'000);
  const DVec3 hip(48, 0, 0), spring(2, 0, 0);
  const Moved moved = push(scene.cloud, hip, spring, {.yieldDepth = 0.2, .pushRate = 0.3, .radius = 8}, scene.radius);
  std::set<std::uint32_t> ids;
  for (const auto& entry : moved.entries) {
    CHECK(ids.insert(entry.number).second);
    CHECK(entry.position == Vec3(moved.positions[entry.number]));
    CHECK(entry.normal == Vec3(moved.normals[entry.number]));
  }
  for (std::uint32_t i = 0; i < scene.cloud.size(); ++i) {
    if (!ids.contains(i)) {
      CHECK(Vec3(moved.positions[i]) == scene.cloud.positions[i]);
      CHECK(Vec3(moved.normals[i]) == scene.cloud.normals[i]);
    }
  }
}

TEST_CASE_FIXTURE(EditFixture, "moved points have the normals of the new shape, on their old side") {
  const Scene scene = makeScene("sphere", 20'000);
  const DVec3 outward(0, 0, 1);
  const Moved moved =
      push(scene.cloud, 46.0 * outward, 4.0 * outward, {.yieldDepth = 0.1, .pushRate = 1, .radius = 12}, scene.radius);
  std::vector<Vec3> positions;
  for (const Vec4& position : moved.positions) positions.emplace_back(position);
  SortedGrid grid(makeHashGrid(Vec3(0), scene.radius, positions.size()), 1);
  grid.build(positions);
  double worst_deg = 0;
  std::size_t clear = 0;
  for (const auto& entry : moved.entries) {
    const DVec3 old(scene.cloud.normals[entry.number]);
    const DVec3 place(entry.position);
    NormalFit fit(scene.radius);
    grid.forEachNear(place, scene.radius,
                     [&](const SortedGrid::Placed& point) { fit.add(DVec3(point.position) - place); });
    const NormalFit::Result expected = fit.normal(old);
    CHECK(glm::dot(DVec3(entry.normal), old) > -1e-5);
    if (expected.flatness < 0.5 && glm::dot(expected.normal, old) > 0.01) {
      ++clear;
      worst_deg = std::max(worst_deg, angleBetween_deg(DVec3(entry.normal), expected.normal));
    }
    CHECK(std::abs(glm::length(DVec3(entry.normal)) - 1) < 1e-5);
  }
  CHECK(moved.entries.size() > 100);
  CHECK(clear > moved.entries.size() * 3 / 4);
  CHECK(worst_deg < 0.1);
}

TEST_CASE_FIXTURE(EditFixture, "a push with a spring no longer than the yield depth moves no point") {
  const Scene scene = makeScene("plane", 5'000);
  const Moved moved = push(scene.cloud, DVec3(0, 0, -0.5), DVec3(0, 0, 0.5),
                           {.yieldDepth = 0.5, .pushRate = 0.5, .radius = 5}, scene.radius);
  CHECK(moved.entries.empty());
}

TEST_CASE_FIXTURE(EditFixture, "coincident and collinear points keep unit normals in an edit") {
  PointCloud cloud;
  // GPU-assisted validation searches all buffers at each access, and lavapipe ends the loops of an invocation after
  // 65,535 iterations, which limits the number of points here.
  constexpr std::size_t kHeap = 700;
  cloud.positions.assign(kHeap, Vec3(0, 0, 0));
  for (int i = 0; i < 1000; ++i) cloud.positions.push_back(Vec3(0.01f * static_cast<float>(i) - 5, 0, 0));
  cloud.normals.assign(cloud.positions.size(), Vec3(0, 0, 1));
  const Moved moved =
      push(cloud, DVec3(0, 0, -1), DVec3(0, 0, 1), {.yieldDepth = 0.1, .pushRate = 0.5, .radius = 3}, 0.5);
  CHECK(moved.entries.size() > kHeap);
  for (const Vec4& normal : moved.normals) {
    CHECK(isFinite(normal));
    CHECK(glm::length(Vec3(normal)) == near(1, 1e-5));
  }
}

TEST_CASE_FIXTURE(EditFixture, "a brush larger than the model moves every point, and the log contains them all") {
  Scene scene = makeScene("sphere", 4'097);
  for (Vec3& normal : scene.cloud.normals) normal = Vec3(0, 0, 1);  // all normals face the brush
  const Moved moved = push(scene.cloud, DVec3(0, 0, -100), DVec3(0, 0, 150),
                           {.yieldDepth = 1, .pushRate = 0.01, .radius = 1000}, scene.radius);
  CHECK(moved.entries.size() == scene.cloud.size());
}

}  // namespace palpate::edit_pass_test
