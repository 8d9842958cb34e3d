// A drag leaves the trench that the hand's motion defines, on each back end: compared with analytic truth, and over a
// plate, whose far side stays.
#include "tests/clay.hpp"
#include "tests/labels.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate::trench_test {

namespace {

/// A plate below the plane: its far side is `thickness` lower, with the same density.
Scene makePlate(std::size_t count, float thickness) {
  Scene scene = makeScene("plane", count);
  for (std::size_t i = 0; i < count; ++i) {
    scene.cloud.positions.push_back(scene.cloud.positions[i] - Vec3(0, 0, thickness));
    scene.cloud.normals.push_back(-scene.cloud.normals[i]);
  }
  return scene;
}

PointCloud draggedOver(TouchBackend& touch, const Scene& plate, float thickness) {
  const ClayGesture gesture = clayDrag(plate, thickness + 1.5, 200);
  for (std::size_t k = 0; k + 150 < gesture.hips.size(); ++k)
    touch.query({.time_s = 1e-3 * static_cast<double>(k), .hip = gesture.hips[k]}, 0);
  touch.finish();
  PointCloud after = plate.cloud;
  CHECK(touch.readBack(after) > 20);
  return after;
}

/// Drags over such a plate without lifting the hand: its far side stays unchanged, and the near one in front of it.
/// Returns the displacement of the near one.
double dragOverPlate(TouchBackend& touch, const Scene& plate, float thickness) {
  const PointCloud after = draggedOver(touch, plate, thickness);
  std::size_t far = 0;
  double lowest = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const bool isFar = after.normals[i].z < -0.5f;
    far += isFar;
    if (isFar)
      CHECK(after.positions[i].z == -thickness);
    else
      lowest = std::min(lowest, static_cast<double>(after.positions[i].z));
  }
  CHECK(far == plate.cloud.size() / 2);
  CHECK(lowest > -static_cast<double>(thickness));
  return lowest;
}

/// Carves through such a plate until the hand is below it: no point may be left beside the plate.
void checkCarvingThroughPlate(TouchBackend& touch, const Scene& plate, double thickness) {
  const ClayGesture gesture = clayDrag(plate, thickness + 2, 100);
  for (std::size_t k = 0; k < gesture.hips.size(); ++k)
    CHECK(touch.query({.time_s = 1e-3 * static_cast<double>(k), .hip = gesture.hips[k]}, 0).valid);
  touch.finish();
  PointCloud after = plate.cloud;
  CHECK(touch.readBack(after) > 20);
  CHECK(after.size() < plate.cloud.size() - 20);
  for (const Vec3& place : after.positions) {
    CHECK(static_cast<double>(place.z) < 0.3);
    CHECK(static_cast<double>(place.z) > -thickness - 0.3);
  }
}

}  // namespace

TEST_CASE_FIXTURE(OnBackEnd, "a drag leaves a trench as deep as the hand, and no points above or below the surface" *
                                 kMoreInFull) {
  using Numbers = std::vector<double>;
  using Names = std::vector<const char*>;
  const Names shapes{"plane", "sphere"};
  const auto depths = onCpuOrGpu(byTier<Numbers>({3}, {2, 3, 4, 6, 9}), byTier<Numbers>({3}, {2, 3, 4, 6, 9, 18}));
  const auto speeds = onCpuOrGpu(byTier<Numbers>({100}, {20, 100, 500}), byTier<Numbers>({300}, {100}));
  for (const char* shape : onCpuOrGpu(shapes, byTier<Names>({"sphere"}, shapes))) {
    const Scene scene = makeScene(shape, byTier(onCpuOrGpu(6'000, 5'000), 20'000));
    for (const BrushKind kind : {BrushKind::push, BrushKind::carve})
      for (const double depth : depths)
        for (const double speed : speeds) {
          CAPTURE(shape);
          CAPTURE(static_cast<int>(kind));
          CAPTURE(depth);
          CAPTURE(speed);
          const auto touch = make(scene.cloud, {.radius = scene.radius, .brush = clayBrush(kind)});
          checkClay(mould(*touch, scene, clayDrag(scene, depth, speed), onCpuOrGpu(1, byTier(2, 1))), depth);
        }
  }
}

TEST_CASE_FIXTURE(OnBackEnd, "the far side of a plate stays unchanged, and the near side stops before it") {
  const float thickness = onCpuOrGpu(3.0f, 4.0f);
  const Scene plate = makePlate(onCpuOrGpu(6'000, 4'000), thickness);
  std::vector<BrushKind> kinds{BrushKind::push};
  if (!kOnGpu) kinds.insert(kinds.end(), {BrushKind::flatten, BrushKind::inflate});  // takes too long
  for (const BrushKind kind : kinds) {
    CAPTURE(static_cast<int>(kind));
    const auto touch = make(plate.cloud, {.radius = plate.radius, .brush = clayBrush(kind)});
    const double lowest = dragOverPlate(*touch, plate, thickness);
    if (kind == BrushKind::push) CHECK(lowest < -1.5);
  }
}

TEST_CASE_FIXTURE(OnBackEnd, "grab carries both sides of a plate, and neither goes through the other") {
  const float thickness = 1;
  const Scene plate = makePlate(onCpuOrGpu(6'000, 4'000), thickness);
  const auto touch = make(plate.cloud, {.radius = plate.radius, .brush = clayBrush(BrushKind::grab)});
  const PointCloud after = draggedOver(*touch, plate, thickness);
  double lowestFar = 0;
  std::size_t through = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (after.normals[i].z >= 0) continue;
    lowestFar = std::min(lowestFar, static_cast<double>(after.positions[i].z));
    for (std::size_t k = 0; k < after.size(); ++k) {
      if (after.normals[k].z <= 0) continue;
      const Vec3 offset = after.positions[k] - after.positions[i];
      const float before = glm::dot(offset, after.normals[i]);
      through += before > 0 && before < thickness && glm::length(offset - before * after.normals[i]) < 0.5f;
    }
  }
  CHECK(lowestFar < -static_cast<double>(thickness) - 1);
  CHECK(through == 0);
}

TEST_CASE_FIXTURE(OnBackEnd, "a plate that is carved through has no points below") {
  const Scene plate = makePlate(onCpuOrGpu(6'000, 4'000), 1);
  const auto touch = make(plate.cloud, {.radius = plate.radius, .brush = clayBrush(BrushKind::carve)});
  checkCarvingThroughPlate(*touch, plate, 1);
}

}  // namespace palpate::trench_test
