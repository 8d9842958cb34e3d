// What the CPU's sculpture requests, against the rules for all neighbours of each point.
#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "tests/edit/tool_at.hpp"

namespace palpate::cpu_requests_test {

namespace {

constexpr double kShapeRadius = 50;  // of the sphere, model units
constexpr std::size_t kCount = 20'000;

ResampleNeighbour neighbourAt(const SculptedPoints& points, std::uint32_t number, const DVec3& from) {
  return {.offset = DVec3(points.positions[number]) - from,
          .normal = DVec3(points.normals[number]),
          .rest = DVec3(points.rests[number]),
          .stroke = points.strokes[number],
          .found = DVec3(points.founds[number].position),
          .foundNormal = DVec3(points.founds[number].normal),
          .spacing = points.spacing(number),
          .isNew = number >= points.fromFile,
          .number = number,
          .unsettled = points.unsettled[number] != 0};
}

bool requestsAnything(const CpuSculpture& sculpture, std::uint32_t point, double radius) {
  const SculptedPoints& points = sculpture.points();
  const DVec3 place(points.positions[point]);
  std::vector<ResampleNeighbour> around;
  const double reach{
      shared::neighbourhoodRadius(static_cast<float>(points.spacing(point)), static_cast<float>(radius))};
  sculpture.grid().forEachNear(place, reach, [&](const SortedGrid::Placed& near) {
    if (near.number != point) around.push_back(neighbourAt(points, near.number, place));
  });
  ResampleNeighbours neighbours(around);
  const double mostReach = static_cast<double>(shared::kReach) * radius;
  const double reachOfNew = point < points.fromFile ? mostReach : double{points.reaches[point - points.fromFile]};
  const ResampleRequest request = resampleRequest(neighbourAt(points, point, place),
                                                  {.neighbours = neighbours, .reach = reachOfNew, .place = place});
  return request.goes || request.inserts;
}

CpuSculpture ballToSculpt(double radius) {
  const PointCloud cloud = sampleShape(*makeShape("sphere", 2 * kShapeRadius), {.count = kCount});
  return {cloud, makeHashGrid(Vec3(-kShapeRadius), radius, kCount), {.radius = radius, .threads = 2}};
}

double supportRadius() { return 4 * kShapeRadius * std::sqrt(4 * std::numbers::pi / static_cast<double>(kCount)); }

}  // namespace

TEST_CASE("points that the CPU's edits settle would request nothing of all of their neighbours") {
  const double radius = supportRadius();
  CpuSculpture sculpture = ballToSculpt(radius);
  const BrushOptions push{.kind = BrushKind::push, .yieldDepth = 0.5, .pushRate = 0.3, .radius = 8};
  std::size_t examined = 0, inserted = 0, removed = 0;
  for (int tick = 0; tick < 200; ++tick) {
    const double depth = std::min(0.1 * tick, 9.0), along = 0.005 * tick;
    const DVec3 outward(std::sin(along), 0, std::cos(along));
    const std::size_t before = sculpture.points().size();
    sculpture.edit(brushAt(push, radius, (kShapeRadius - depth) * outward, depth * outward));
    const SculptedPoints& points = sculpture.points();
    const auto gone =
        std::ranges::count_if(sculpture.changed(), [&](std::uint32_t point) { return !points.there[point]; });
    inserted += points.size() - before;
    removed += static_cast<std::size_t>(gone);
    if (points.size() > before || gone > 0) continue;  // the requests were made with other neighbours
    for (const std::uint32_t point : sculpture.changed()) {
      if (points.unsettled[point]) continue;
      ++examined;
      REQUIRE(!requestsAnything(sculpture, point, radius));
    }
  }
  CAPTURE(inserted);
  CAPTURE(removed);
  CHECK(inserted > 100);
  CHECK(removed > 0);
  CHECK(examined > 1000);
}

TEST_CASE("of points that have come too near to others one each goes, although no gap is around them") {
  const double radius = supportRadius();
  CpuSculpture sculpture = ballToSculpt(radius);
  const SculptedPoints& points = sculpture.points();
  // One more point beside every fifth one under the tool: taken from far away.
  std::vector<PointChange> changes;
  std::uint32_t spare = 0;
  for (std::uint32_t point = 0; point < points.size(); point += 5) {
    if (points.positions[point].z < 0.997f * static_cast<float>(kShapeRadius)) continue;
    while (points.positions[spare].z > 0) ++spare;
    PointState beside = points.state(point);
    beside.number = beside.parent = spare;
    beside.position.x += 0.2f * static_cast<float>(points.spacing(point));
    changes.push_back({points.state(spare++), beside});
  }
  REQUIRE(changes.size() >= 3);
  sculpture.set(changes);
  const BrushOptions push{.kind = BrushKind::push, .yieldDepth = 0.5, .pushRate = 0.3, .radius = 8};
  for (int tick = 0; tick < 3; ++tick)
    sculpture.edit(brushAt(push, radius, DVec3(0, 0, kShapeRadius - 2), DVec3(0, 0, 2)));
  const auto gone =
      std::ranges::count_if(changes, [&](const PointChange& change) { return !points.there[change.to.number]; });
  CHECK(static_cast<std::size_t>(gone) >= changes.size() - 1);
}

}  // namespace palpate::cpu_requests_test
