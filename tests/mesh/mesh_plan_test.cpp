// The points that a mesh uses: dense parts and duplicates are thinned, sparse parts are not.
#include "engine/mesh/mesh_plan.hpp"

#include <doctest/doctest.h>

#include <set>

#include "engine/cloud/spacing.hpp"
#include "tests/near.hpp"

namespace palpate::mesh_plan_test {

namespace {

/// A square of 10 x 10 from `x` on, with `side` x `side` points, `copies` at each position.
void addSquare(PointCloud& cloud, double x, int side, int copies = 1) {
  for (int i = 0; i < side * side; ++i)
    for (int k = 0; k < copies; ++k) {
      cloud.positions.emplace_back(DVec3(x + 10.0 * (i % side) / side, 10.0 * (i / side) / side, 0));
      cloud.normals.emplace_back(0.f, 0.f, 1.f);
    }
}

MeshPlan planOf(const PointCloud& cloud, const MeshOptions& options) {
  return thinned(planMesh(boundsOf(cloud), meanSpacing(cloud), options), cloud);
}

std::size_t usedOf(const PointCloud& cloud, const MeshPlan& plan, double from, double to) {
  std::size_t used = 0;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const double x = cloud.positions[i].x;
    used += x >= from && x < to && plan.uses(i);
  }
  return used;
}

}  // namespace

TEST_CASE("a mesh uses one of many points at the same position, so that duplicates cost no time") {
  PointCloud one, many;
  addSquare(one, 0, 40);
  addSquare(many, 0, 40, 50);
  const MeshOptions options{.resolution = 32};
  const MeshPlan alone = planOf(one, options), plan = planOf(many, options);
  CHECK(usedOf(one, alone, 0, 10) == one.size());
  CHECK(alone.share == 1);
  CHECK(usedOf(many, plan, 0, 10) == one.size());
  CHECK(plan.share == near(1.0 / 50, 1e-9));
  std::set<std::pair<float, float>> positions;
  for (std::uint32_t i = 0; i < many.size(); ++i)
    if (plan.uses(i)) positions.emplace(many.positions[i].x, many.positions[i].y);
  CHECK(positions.size() == one.size());
}

TEST_CASE("a wide support radius thins the dense part of a cloud, and no point of the sparse one") {
  PointCloud cloud;
  addSquare(cloud, 0, 200);
  addSquare(cloud, 10, 20);
  const MeshPlan plan = planOf(cloud, {.resolution = 64, .radius = 2});
  CHECK(usedOf(cloud, plan, 10.4, 20) == 380);  // all but the column at the dense part
  const std::size_t dense = usedOf(cloud, plan, 0, 10);
  CHECK(dense > 400);  // five spacings within the radius
  CHECK(dense < 1500);
}

TEST_CASE("the density counts points, so that its mesh thins them by chance") {
  PointCloud cloud;
  addSquare(cloud, 0, 40, 50);
  const MeshPlan plan = planOf(cloud, {.resolution = 32, .surface = MeshSurface::density});
  CHECK(plan.chosen.empty());
}

}  // namespace palpate::mesh_plan_test
