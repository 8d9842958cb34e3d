// Insertion and removal of points: individual decisions, and their effect on whole surfaces.
#include "engine/edit/resampling.hpp"

#include <doctest/doctest.h>

#include <memory>

#include <numbers>
#include <random>
#include <set>

#include "engine/core/clock.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "tests/edit/surface_gaps.hpp"
#include "tests/edit/tool_at.hpp"
#include "tests/scenes.hpp"

namespace palpate::resample_test {

namespace {

const DVec3 kUp(0, 0, 1);

// At its position as loaded.
ResampleNeighbour pointAt(const DVec3& offset, std::uint32_t number, bool unsettled = false) {
  return {.offset = offset, .normal = kUp, .rest = offset, .spacing = 1, .number = number, .unsettled = unsettled};
}

std::unique_ptr<ResampleNeighbours> these(std::span<const ResampleNeighbour> neighbours) {
  return std::make_unique<ResampleNeighbours>(neighbours);
}

ResampleRequest requestOf(const ResampleNeighbour& self, std::span<const ResampleNeighbour> neighbours) {
  return resampleRequest(self, {.neighbours = *these(neighbours)});
}

// Six neighbours around, the first of which an edit has moved to `far` times its distance.
std::vector<ResampleNeighbour> ring(double far) {
  std::vector<ResampleNeighbour> points;
  for (std::uint32_t k = 0; k < 6; ++k) {
    const double angle = (k + 0.5) * std::numbers::pi / 3;
    const DVec3 direction(std::cos(angle), std::sin(angle), 0);
    points.push_back(pointAt((k == 0 ? far : 1.0) * direction, k + 10));
    points.back().rest = direction;
  }
  return points;
}

// A flat square sheet of points about a spacing of 1 apart, `side` points along an edge.
PointCloud sheet(int side, double uneven = 0, std::uint32_t seed = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(-uneven, uneven);
  PointCloud cloud;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) cloud.positions.push_back(Vec3(DVec3(x + offset(random), y + offset(random), 0)));
  cloud.normals.assign(cloud.positions.size(), Vec3(kUp));
  return cloud;
}

// Every other column of squares of five spacings is eight times as dense in both directions.
PointCloud densePatches(int side) {
  PointCloud cloud = sheet(side, 0.3);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> place(0, static_cast<float>(side - 1));
  for (int k = 0; k < side * side * 16; ++k) {
    const Vec3 p{place(random), place(random), 0};
    if (static_cast<int>(p.x) / 5 % 2 == 0 && static_cast<int>(p.y) / 5 % 2 == 0) cloud.positions.push_back(p);
  }
  cloud.normals.assign(cloud.positions.size(), Vec3(kUp));
  return cloud;
}

// Moves everything slightly, so that all points are examined, and waits until none is inserted or removed.
int shakeUntilSettled(CpuSculpture& sculpture, double radius) {
  const BrushOptions everything{.kind = BrushKind::grab, .yieldDepth = 0, .radius = 1e4, .strength = 1, .falloff = 0};
  const DVec3 hip(0, 0, -1);
  sculpture.edit(brushAt(everything, radius, hip, kUp, {0, 0, 0.01}));
  const PlacedBrush nothing(everything, radius, {});
  int ticks = 1;
  while (sculpture.someWait()) sculpture.edit(nothing);  // until all have been examined
  for (; !sculpture.settled() && ticks < 1000; ++ticks) sculpture.edit(nothing);
  return ticks;
}

// Cuts a sheet into halves three spacings apart.
void tear(CpuSculpture& sculpture) {
  std::vector<PointChange> apart;
  for (std::uint32_t i = 0; i < sculpture.points().size(); ++i) {
    if (sculpture.points().positions[i].x < 20.5f) continue;
    PointChange& change = apart.emplace_back(sculpture.points().state(i), sculpture.points().state(i));
    change.to.position.x += 2;
  }
  sculpture.set(apart);
}

PointCloud cloudOf(const CpuSculpture& sculpture) {
  PointCloud cloud;
  for (std::uint32_t i = 0; i < sculpture.points().size(); ++i) {
    if (!sculpture.points().there[i]) continue;
    cloud.positions.push_back(sculpture.points().positions[i]);
    cloud.normals.push_back(sculpture.points().normals[i]);
  }
  return cloud;
}

}  // namespace

TEST_CASE("a sector is a sixth of a full turn, counter-clockwise") {
  for (int k = 0; k < 360; ++k) {
    const double angle = (k + 0.5) * std::numbers::pi / 180;
    CHECK(shared::sectorOf(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))) ==
          static_cast<shared::uint>(k / 60));
  }
  CHECK(shared::sectorOf(1, 0) == 0);
  CHECK(shared::sectorOf(-1, 0) == 3);
  CHECK(shared::sectorOf(0, 0) < shared::kGapSectors);
}

TEST_CASE("the midpoint of two points of a sphere lies on it") {
  for (const float angle : {0.05f, 0.2f, 0.4f}) {
    const Vec3 a(0, 0, 1), b(std::sin(angle), 0, std::cos(angle));
    const Vec3 middle = a + shared::halfWay(b - a, a, b);
    CHECK(std::abs(glm::length(middle) - 1) < 0.03f * angle * angle * angle * angle + 1e-6f);
    CHECK(glm::dot(middle, Vec3(0.5f * (a + b))) > 0.99f * glm::length(0.5f * (a + b)));
  }
}

TEST_CASE("a point with near neighbours requests nothing, and behind a gap one point in its middle") {
  const ResampleRequest content = requestOf(pointAt(DVec3(0), 1), ring(1.5));
  CHECK_FALSE(content.inserts);
  CHECK_FALSE(content.goes);
  CHECK_FALSE(content.unsettled);
  const auto gap = ring(1.8);
  const ResampleRequest request = requestOf(pointAt(DVec3(0), 1), gap);
  CHECK(request.inserts);
  CHECK(request.unsettled);
  CHECK(request.other == 10);
  CHECK(glm::distance(request.offset, 0.5 * gap[0].offset) < 1e-12);
}

TEST_CASE("no point is requested beyond a border, near an existing one, or on the other side of a sheet") {
  auto border = ring(1.8);
  border.erase(border.begin());
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), border).inserts);

  auto taken = ring(1.8);
  taken.push_back(pointAt(0.5 * taken[0].offset + DVec3(0, 0, 0.55), 30));
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), taken).inserts);
  taken.back().normal = -kUp;  // on the back of the sheet
  CHECK(requestOf(pointAt(DVec3(0), 1), taken).inserts);

  auto back = ring(1.8);
  back[0].normal = -kUp;
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), back).inserts);
}

TEST_CASE("of two crowded points one is removed, the unsettled or the later one, never both") {
  const auto goes = [](const ResampleNeighbour& self, ResampleNeighbour other) {
    other.offset = {0.3, 0, 0};
    other.rest = {1, 0, 0};
    return requestOf(self, std::vector{other}).goes;
  };
  const auto at = [](std::uint32_t number, bool unsettled) { return pointAt(DVec3(0), number, unsettled); };
  const auto compressed = [](const DVec3& offset, std::uint32_t number) {
    ResampleNeighbour point = pointAt(offset, number, true);
    point.rest = 3.0 * offset;
    return point;
  };
  CHECK(goes(at(7, true), at(3, true)));
  CHECK_FALSE(goes(at(3, true), at(7, true)));
  CHECK(goes(at(3, true), at(7, false)));
  CHECK_FALSE(goes(at(7, false), at(3, true)));
  // In a chain the middle point is removed for the first; the last waits to see whether it may stay.
  const ResampleRequest last =
      requestOf(at(9, true), std::vector{compressed({0.3, 0, 0}, 5), compressed({0.6, 0, 0}, 2)});
  CHECK_FALSE(last.goes);
  CHECK(last.unsettled);
}

TEST_CASE("the request of a point does not depend on the order of its neighbours") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-3, 3);
  std::size_t inserted = 0, gone = 0;
  for (int round = 0; round < 400; ++round) {
    std::vector<ResampleNeighbour> neighbours;
    for (std::uint32_t k = 0; k < 16; ++k) {
      neighbours.push_back(pointAt({place(random), place(random), 0.1 * place(random)}, k, k % 3 > 0));
      neighbours.back().rest = {place(random), place(random), 0};
    }
    neighbours.push_back(neighbours[3]);  // two at equal distance
    neighbours.back().number = 40;
    const ResampleNeighbour self = pointAt(DVec3(0), 20, true);
    const ResampleRequest request = requestOf(self, neighbours);
    inserted += request.inserts;
    gone += request.goes;
    for (int shuffle = 0; shuffle < 4; ++shuffle) {
      std::ranges::shuffle(neighbours, random);
      const ResampleRequest again = requestOf(self, neighbours);
      CHECK(again.goes == request.goes);
      CHECK(again.inserts == request.inserts);
      CHECK(again.unsettled == request.unsettled);
      CHECK(again.other == request.other);
      CHECK(again.offset == request.offset);
    }
  }
  CHECK(inserted > 100);
  CHECK(gone > 50);
}

TEST_CASE("of all claims near a position the one with the smallest number wins, without blocking others") {
  const std::vector<std::pair<Vec3, std::uint32_t>> wanted{
      {{0.1f, 0.1f, 0}, 5}, {{0.5f, 0.1f, 0}, 3}, {{0.8f, 0.1f, 0}, 7}, {{1.3f, 0.1f, 0}, 9}, {{9, 0, 0}, 8}};
  InsertionClaims claims(1);
  for (int round = 0; round < 2; ++round) {
    claims.begin(1);
    for (const auto& [place, number] : wanted) claims.claim(place, number);
    for (const auto& [place, number] : wanted) claims.confirm(place, number);
    const auto stands = [&](std::size_t i) { return claims.stands(wanted[i].first, wanted[i].second); };
    CHECK_FALSE(stands(0));  // in the cell of the second
    CHECK(stands(1));
    CHECK_FALSE(stands(2));  // too close to the second
    CHECK_FALSE(stands(3));  // in the cell of the third
    CHECK(stands(4));
  }
  claims.begin(1);
  claims.claim(wanted[0].first, 5);
  claims.confirm(wanted[0].first, 5);
  CHECK(claims.stands(wanted[0].first, 5));
}

TEST_CASE(
    "where a stroke has inserted a point that did not stay it does not insert one again, but the next stroke does") {
  const std::vector<ResampleNeighbour> gap = ring(2);
  const DVec3 place(30, -7, 2);
  InsertionClaims claims(1);
  const auto request = [&] {
    return resampleRequest(pointAt(DVec3(0), 0), {.neighbours = *these(gap), .claims = &claims, .place = place});
  };
  claims.begin(1);
  REQUIRE(request().inserts);
  const Vec3 at(place + request().offset);
  claims.grant(Vec3(place));  // another position
  CHECK(request().inserts);
  claims.grant(at);
  CHECK_FALSE(request().inserts);
  CHECK_FALSE(request().unsettled);
  claims.begin(1);
  CHECK_FALSE(request().inserts);
  claims.begin(2);
  CHECK(request().inserts);
}

TEST_CASE("uneven clouds and clouds with holes stay as loaded, however often they are examined") {
  const Scene sphere = makeScene("sphere", 20'000);
  PointCloud holed = sheet(40, 0.2);
  std::erase_if(holed.positions, [](const Vec3& p) { return glm::distance(p, Vec3(20.3f, 19.6f, 0)) < 1.9f; });
  holed.normals.resize(holed.positions.size());
  const std::vector<std::pair<PointCloud, double>> clouds{
      {sphere.cloud, sphere.radius}, {sheet(40, 0.6), 4}, {holed, 4}, {densePatches(40), 4}};
  for (const auto& [cloud, radius] : clouds) {
    CpuSculpture sculpture(cloud, makeHashGrid(Vec3(0), radius, cloud.size()), {.radius = radius});
    for (int k = 0; k < 3; ++k) CHECK(shakeUntilSettled(sculpture, radius) < 5);
    CHECK(sculpture.points().size() == cloud.size());
    CHECK(std::ranges::count(sculpture.points().there, 0) == 0);
  }
}

TEST_CASE("a gap torn by an edit closes evenly and does not widen a border") {
  const PointCloud whole = sheet(40, 0.2);
  CpuSculpture sculpture(whole, makeHashGrid(Vec3(0), 4, whole.size()), {.radius = 4});
  tear(sculpture);
  const auto middle = [](const DVec3& p) { return std::abs(p.x - 21.5) < 8 && std::abs(p.y - 20) < 8; };
  CHECK(SurfaceGapFinder(cloudOf(sculpture), 4, 1).find(middle).widest > 1.2);
  CHECK(shakeUntilSettled(sculpture, 4) < 30);
  const PointCloud closed = cloudOf(sculpture);
  const SurfaceGaps gaps = SurfaceGapFinder(closed, 4, 1).find(middle);
  CHECK(gaps.widest < 1.25);
  CHECK(gaps.closest > 0.4);
  CHECK(closed.size() > whole.size() + 60);
  CHECK(closed.size() < whole.size() + 110);
  for (const Vec3& p : closed.positions) {
    CHECK(p.y > -0.25f);
    CHECK(p.y < 39.25f);
  }
}

TEST_CASE("a gap is measured by the coarser of its ends, whose target spacing the new point gets") {
  auto gap = ring(1.8);
  gap[0].spacing = 1.5;
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), gap).inserts);
  gap = ring(2.4);
  gap[0].spacing = 1.5;
  const ResampleRequest request = requestOf(pointAt(DVec3(0), 1), gap);
  CHECK(request.inserts);
  CHECK(request.takesAfterOther);
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), ring(2.4)).takesAfterOther);
}

TEST_CASE("no point is requested beyond its reach, or if the list of neighbours is incomplete") {
  const auto gap = ring(1.8);
  const ResampleNeighbour self = pointAt(DVec3(0), 1);
  CHECK(resampleRequest(self, {.neighbours = *these(gap), .reach = 0.91}).inserts);
  CHECK_FALSE(resampleRequest(self, {.neighbours = *these(gap), .reach = 0.89}).inserts);
  CHECK_FALSE(resampleRequest(self, {.neighbours = *these(gap), .fills = false}).inserts);
}

TEST_CASE("no point is added where it would crowd one with a wider target, or one of possibly the same sheet") {
  auto gap = ring(1.8);
  const ResampleNeighbour self = pointAt(DVec3(0), 1);
  const DVec3 place = 0.5 * gap[0].offset, aside = glm::normalize(DVec3(-place.y, place.x, 0));
  gap.push_back(pointAt(place + aside, 30));
  CHECK(requestOf(self, gap).inserts);
  gap.back().spacing = 3;
  CHECK_FALSE(requestOf(self, gap).inserts);
  gap.back() = pointAt(place + DVec3(0, 0, 0.3), 30);
  gap.back().normal = glm::normalize(DVec3(1, 0, -0.3));
  CHECK_FALSE(requestOf(self, gap).inserts);
  gap.back().normal = -kUp;
  CHECK(requestOf(self, gap).inserts);
}

TEST_CASE("a point waits for the removal of another point only if that one is examined") {
  const auto row = [](bool firstIsExamined) {
    std::vector<ResampleNeighbour> points{pointAt({0.3, 0, 0}, 20, firstIsExamined), pointAt({0.6, 0, 0}, 10)};
    for (ResampleNeighbour& point : points) point.rest *= 10;
    return points;
  };
  const ResampleNeighbour self = pointAt(DVec3(0), 30, true);
  CHECK(requestOf(self, row(true)).unsettled);
  CHECK_FALSE(requestOf(self, row(true)).goes);
  CHECK(requestOf(self, row(false)).goes);
}

TEST_CASE("while a ball carves, points outside the solid are removed, and none is added where it would be removed") {
  // The ends of a gap are slightly above a plane at rest, which is seen slightly farther away.
  auto gap = ring(1.8);
  const ResampleNeighbour self = pointAt(DVec3(0), 1);
  const auto raised = [&](double height) {
    auto all = gap;
    for (ResampleNeighbour& each : all) each.rest = each.offset - DVec3(0, 0, 5);
    for (std::uint32_t k = 0; k < 12; ++k) {
      const double angle = k * std::numbers::pi / 6;
      all.push_back(pointAt(DVec3(0.9 + 2.5 * std::cos(angle), 2.5 * std::sin(angle), -height), 40 + k));
      all.back().atRest = true;
    }
    return all;
  };
  const auto request = [&](double height, bool carves) {
    const auto all = raised(height);
    return resampleRequest(self, {.neighbours = *these(all), .carves = carves});
  };
  CHECK(request(0.05, false).inserts);
  CHECK_FALSE(request(0.05, true).goes);
  CHECK_FALSE(request(0.05, true).inserts);
  CHECK(request(-0.05, true).inserts);
  CHECK(request(0.15, true).goes);
  CHECK_FALSE(request(0.15, false).goes);
  const auto all = raised(0.15);
  CHECK_FALSE(resampleRequest(self, {.neighbours = *these(all), .carves = true, .moved = false}).goes);
}

namespace {

/// Points inserted into carved ground without brush motion since, and how many of them were removed again.
struct CameAndWent {
  std::size_t came = 0, went = 0;
};

CameAndWent carveWildGround(std::uint32_t seed) {
  PointCloud cloud = sheet(40, 0.4);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> height(-1.5f, 1.5f), tilt(-0.8f, 0.8f);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.positions[i].z = height(random);
    cloud.normals[i] = glm::normalize(Vec3{tilt(random), tilt(random), 1});
  }
  const double radius = 4;
  CpuSculpture sculpture(cloud, makeHashGrid(Vec3(0), radius, cloud.size()), {.radius = radius});
  const BrushOptions carve{.kind = BrushKind::carve, .yieldDepth = 0, .radius = 5, .strength = 0.5};
  DVec3 hip(10, 20, -3);
  for (int tick = 0; tick < 200; ++tick) {
    hip += DVec3(0.1, 0, 0);
    sculpture.edit(brushAt(carve, radius, hip, kUp));
  }
  CHECK(sculpture.points().size() > cloud.size());
  const PlacedBrush lifted(carve, radius, {});
  int ticks = 0;
  while (!sculpture.settled() && ++ticks < 300) sculpture.edit(lifted);
  CHECK(sculpture.settled());
  CameAndWent found;
  for (std::size_t i = cloud.size(); i < sculpture.points().size(); ++i) {
    const bool untouched = sculpture.points().reaches[i - cloud.size()] < shared::kReach * static_cast<float>(radius);
    found.came += untouched;
    found.went += untouched && !sculpture.points().there[i];
  }
  return found;
}

}  // namespace

TEST_CASE("ground without a unique surface settles after carving, and hardly any added point is removed again") {
  CameAndWent all;
  for (std::uint32_t seed = 1; seed <= 24; ++seed) {
    CAPTURE(seed);
    const CameAndWent found = carveWildGround(seed);
    all.came += found.came;
    all.went += found.went;
  }
  // Over 200 such grounds, 19 of 986 points were removed again; rounding decides which.
  CHECK(all.came > 48);
  CHECK(20 * all.went <= all.came);
}

TEST_CASE("midpoints over an edge, or between normals that disagree, stay within the planes of the ends") {
  std::mt19937 random(8);
  std::normal_distribution<double> side;
  const auto direction = [&] { return glm::normalize(DVec3{side(random), side(random), side(random)}); };
  for (int k = 0; k < 2000; ++k) {
    const DVec3 normal = direction(), other = direction();
    const Vec3 offset(direction()), place = shared::halfWay(offset, Vec3(normal), Vec3(other));
    const double chord = 0.5 * glm::dot(DVec3(offset), normal), chordBack = -0.5 * glm::dot(DVec3(offset), other);
    CHECK(glm::dot(DVec3(place), normal) < std::max(0.0, chord) + 1e-6);
    CHECK(glm::dot(DVec3(place - offset), other) < std::max(0.0, chordBack) + 1e-6);
  }
}

TEST_CASE("many coincident points become one") {
  PointCloud cloud = sheet(12);
  cloud.positions.insert(cloud.positions.end(), 3000, cloud.positions[40]);
  const std::size_t single = cloud.size() - 3000;
  cloud.normals.assign(cloud.positions.size(), Vec3(kUp));
  CpuSculpture heap(cloud, makeHashGrid(Vec3(0), 4, cloud.size()), {.radius = 4});
  CHECK(shakeUntilSettled(heap, 4) < 100);
  std::size_t left = 0;
  for (std::uint32_t i = 0; i < heap.points().size(); ++i)
    left += heap.points().there[i] && glm::distance(heap.points().positions[i], cloud.positions[40]) < 0.1f;
  CHECK(left == 1);
  CHECK(cloudOf(heap).size() <= single + 20);
}

TEST_CASE("resampling does not depend on the cells of the index or the number of threads") {
  const PointCloud rough = sheet(60, 0.6);
  std::vector<Vec3> first;
  for (const double cell : {1.0, 0.4, 2.5})
    for (const unsigned threads : {1u, 3u}) {
      CpuSculpture sculpture(rough, makeHashGrid(Vec3(0), cell * 4, rough.size()), {.radius = 4, .threads = threads});
      tear(sculpture);
      shakeUntilSettled(sculpture, 4);
      if (first.empty()) first = sculpture.points().positions;
      CHECK(sculpture.points().positions == first);
    }
  CHECK(first.size() > rough.size());
}

TEST_CASE("a brush as wide as the cloud defers some points to the next ticks, and reaches all of them") {
  const auto shape = makeShape("sphere", 100);
  PointCloud cloud = sampleShape(*shape, {.count = 15'000});
  const double radius = 4 * std::sqrt(4 * std::numbers::pi * 50 * 50 / 15'000);
  CpuSculpture sculpture(cloud, makeHashGrid(Vec3(0), static_cast<float>(radius), cloud.size()), {.radius = radius});
  const DVec3 hip(0, 0, 48), spring(0, 0, 2);
  const BrushOptions narrow{.kind = BrushKind::inflate, .radius = 6};
  sculpture.edit(brushAt(narrow, radius, hip, spring));
  CHECK(!sculpture.changed().empty());
  CHECK(!sculpture.someWait());
  CHECK(sculpture.settled());
  const BrushOptions wide{.kind = BrushKind::inflate, .radius = 150};
  const Stopwatch watch;
  sculpture.edit(brushAt(wide, radius, hip, spring));
  MESSAGE("an edit of ", sculpture.changed().size(), " points: ", watch.elapsed_us() * 1e-3, " ms");
  CHECK(sculpture.changed().size() > 9'000);
  CHECK(sculpture.someWait());
  CHECK(!sculpture.settled());
  const PlacedBrush none = brushAt(wide, radius, DVec3(0, 0, 90), DVec3(0));
  int ticks = 0;
  for (; ticks < 40 && sculpture.someWait(); ++ticks) sculpture.edit(none);
  CHECK(ticks >= 8);
  CHECK(ticks < 40);
  // Each normal matches the point's final position.
  double worst = 1;
  for (std::size_t i = 0; i < sculpture.points().size(); ++i)
    worst = std::min(
        worst, glm::dot(DVec3(sculpture.points().normals[i]), glm::normalize(DVec3(sculpture.points().positions[i]))));
  CHECK(worst > 0.98);
}

}  // namespace palpate::resample_test
