#include "engine/study/edit_judge.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/study/uneven_clouds.hpp"
#include "tests/near.hpp"

namespace palpate::test::edit_judge_test {
namespace {

using Words = std::vector<std::string_view>;

// A square grid, 1 apart, that faces up.
PointCloud grid(int side, double spacing = 1) {
  PointCloud cloud;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      cloud.positions.emplace_back(spacing * (x - side / 2), spacing * (y - side / 2), 0);
      cloud.normals.emplace_back(0, 0, 1);
    }
  return cloud;
}

// A brush of radius 3 at the centre, a carving one slightly above it; support radius 4.
BrushPath middleTool(bool carves = false) {
  return {.centers = {DVec3(0, 0, carves ? 2 : 0)}, .radius = 3, .support = 4, .carves = carves};
}

struct Edited {
  PointCloud cloud;
  std::vector<PointState> states;

  explicit Edited(PointCloud before) : cloud(std::move(before)), states(statesOf(cloud)) {}
  std::uint32_t at(double x, double y) const {
    const auto found = std::ranges::find_if(cloud.positions, [&](const Vec3& p) {
      return glm::distance(DVec3(p), {x, y, p.z}) < 0.1;
    });
    return static_cast<std::uint32_t>(found - cloud.positions.begin());
  }
  void insert(const DVec3& place, std::uint32_t parent, const DVec3& normal = {0, 0, 1}) {
    states.push_back({.position = Vec3(place),
                      .id = static_cast<std::uint32_t>(states.size()),
                      .normal = Vec3(normal),
                      .parent = parent});
  }
  EditVerdict verdict(const BrushPath& way = middleTool()) const { return EditJudge(cloud).judge(states, way); }
};

}  // namespace

TEST_CASE("the path of a brush is the line through its positions") {
  const std::vector<DVec3> way{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}};
  CHECK(distanceToWay({5, 3, 0}, way) == near(3, 1e-6));
  CHECK(distanceToWay({12, 5, 0}, way) == near(2, 1e-6));
  CHECK(distanceToWay({-3, -4, 0}, way) == near(5, 1e-6));
  CHECK(distanceToWay({1, 2, 2}, std::span(way).first(1)) == near(3, 1e-6));
  CHECK(std::isinf(distanceToWay({0, 0, 0}, {})));
}

TEST_CASE("an edit within its bounds has no violations") {
  Edited edited(grid(41));
  const std::uint32_t moved = edited.at(1, 0), gone = edited.at(2, 0), painted = edited.at(0, 1);
  edited.states[moved].position.z = -0.1F;
  edited.states[gone].id |= PointState::kGone;
  edited.states[painted].color = 0xff0000ff;
  edited.insert({6.5, 0.5, 0}, moved);
  const EditVerdict verdict = edited.verdict();
  CHECK(verdict.moved == 1);
  CHECK(verdict.removed == 1);
  CHECK(verdict.painted == 1);
  CHECK(verdict.inserted == 1);
  CHECK(verdict.farthestMoved == near((2 - 3) / 4.0, 1e-6));
  CHECK(verdict.farthestInserted == near((std::hypot(6.5, 0.5) - 3) / 4, 1e-6));
  CHECK(verdict.nearest == near(std::sqrt(0.5), 0.03));
  CHECK(verdict.broken(true) == Words{});
}

TEST_CASE("points that move, are removed or change colour beyond the brush are reported") {
  for (const int what : {0, 1, 2}) {
    Edited edited(grid(41));
    PointState& far = edited.states[edited.at(4, 0)];
    if (what == 0) far.position.z = -1e-4F;
    if (what == 1) far.id |= PointState::kGone;
    if (what == 2) far.color = 1;
    CHECK(edited.verdict().farthestMoved == near(0.25, 1e-6));
    CHECK(edited.verdict().broken(false) == Words{"moves far"});
  }
}

TEST_CASE("new points beyond the brush and a support radius are reported") {
  Edited edited(grid(41));
  edited.insert({7.5, 0.5, 0}, 0);
  CHECK(edited.verdict().broken(false) == Words{"inserts far"});
  // Without a brush stroke no change is allowed.
  CHECK(edited.verdict({.centers = {}, .radius = 3, .support = 4}).broken(false) == Words{"inserts far"});
}

TEST_CASE("a new point too near to another of its sheet is reported, but not one near to another sheet") {
  Edited edited(grid(41));
  edited.insert({0.2, 0, 0}, edited.at(0, 0));
  CHECK(edited.verdict().crowded == 1);
  CHECK(edited.verdict().nearest == near(0.2, 0.03));
  CHECK(edited.verdict().broken(false) == Words{"crowds"});
  edited.states.back().normal = Vec3(0, 0, -1);
  CHECK(edited.verdict().crowded == 0);
}

TEST_CASE("without tolerance one crowded point, one flipped normal and a thousandth of a radius are reported") {
  Edited edited(grid(41));
  edited.insert({0.35, 0, 0}, edited.at(0, 0));
  CHECK(edited.verdict().crowded == 1);
  CHECK(edited.verdict().broken(false) == Words{});  // one of many measured positions may be wrong
  CHECK(edited.verdict().broken(false, true) == Words{"crowds"});

  const EditVerdict turned{.moved = 1000, .sided = 1000, .turned = 1};
  CHECK(turned.broken(false) == Words{});
  CHECK(turned.broken(false, true) == Words{"turns normals"});
  const EditVerdict far{.moved = 1, .farthestMoved = 0.001};
  CHECK(far.broken(false) == Words{});
  CHECK(far.broken(false, true) == Words{"moves far"});
  const EditVerdict nothing{};
  CHECK(nothing.broken(true, true) == Words{});
}

TEST_CASE("a share of points up to the tolerance is accepted, and one more is not") {
  for (const auto& [crowded, outside, turned, words] :
       {std::tuple(20u, 10u, 10u, Words{}), std::tuple(21u, 10u, 10u, Words{"crowds"}),
        std::tuple(20u, 11u, 10u, Words{"grows"}), std::tuple(20u, 10u, 11u, Words{"turns normals"})}) {
    const EditVerdict verdict{
        .inserted = 1000, .crowded = crowded, .nearest = 0.3, .outside = outside, .sided = 1000, .turned = turned};
    CHECK(verdict.broken(true) == words);
  }
}

TEST_CASE("two coincident new points are reported, whatever is around them") {
  Edited edited(grid(41));
  edited.insert({0.5, 0.5, 0}, edited.at(0, 0));
  CHECK(edited.verdict().broken(false) == Words{});
  edited.insert({0.5, 0.5001, 0}, edited.at(0, 0));
  CHECK(edited.verdict().crowded == 2);
  CHECK(edited.verdict().broken(false) == Words{"crowds"});
}

TEST_CASE("the spacing at a position is that of its own sheet and density") {
  for (const double spacing : {0.1, 1.0, 20.0}) {
    const PointCloud even = grid(41, spacing);
    // Disc counts are between those of a lattice and of random points: 2.2 % wide here.
    CHECK(EditJudge(even).spacingAt({0.3 * spacing, 0, 0}, {0, 0, 1}) / spacing == near(1.022, 0.002));
  }
  const UnevenCloud patches = makeUnevenCloud("patches", 15'000);
  EditJudge judge(patches.cloud);
  const DVec3 side = 8.0 * patches.towards;
  CHECK(judge.spacingAt(patches.place - side, patches.normal) == near(0.91, 0.06));
  CHECK(judge.spacingAt(patches.place + side, patches.normal) == near(4.1, 0.15));
  // Two sheets do not count as one denser sheet.
  const PointCloud plate = makePlate(20'000, 0.8);
  CHECK(EditJudge(plate).spacingAt({0, 0, 0.4}, {0, 0, 1}) == near(1, 0.03));
  // Coincident points count once.
  PointCloud twice = grid(41);
  twice.positions.insert(twice.positions.end(), twice.positions.begin(), twice.positions.end());
  twice.normals.insert(twice.normals.end(), twice.normals.begin(), twice.normals.end());
  CHECK(EditJudge(twice).spacingAt({0.3, 0, 0}, {0, 0, 1}) == near(1, 0.1));
}

TEST_CASE("height above a surface is exact on curves, on plates and at edges") {
  const UnevenCloud sphere = makeUnevenCloud("gradient", 15'000), plate = makeUnevenCloud("plate", 20'000);
  const EditJudge onSphere(sphere.cloud), onPlate(plate.cloud);
  for (const double height : {-3.0, -0.5, 0.0, 0.2, 2.0, 6.0})
    for (const DVec3& d : {DVec3(0, 0, 1), DVec3(0.8, 0.6, 0), DVec3(-0.6, 0, 0.8)})
      CHECK(onSphere.heightAt((50 + height) * d) == within(height, 0.01));
  for (const double z : {-3.0, -0.4, 0.0, 0.3, 0.9}) {
    const DVec3 p(7.3, -11.1, z);
    CHECK(onPlate.heightAt(p) == within(plate.signedDistance(p), 0.01));
  }
  const auto cube = makeShape("cube", 20);
  const PointCloud points = sampleShape(*cube, {.count = 2400});  // 1 apart
  const EditJudge onCube(points);
  CHECK(onCube.heightAt({9.99, 0, 9.99}) < 0.1);    // on the edge, where a round fit is too low
  CHECK(onCube.heightAt({12, 0.3, 10}) > 0.5);      // a fin that continues along a face
  CHECK(onCube.heightAt({10.7, 0.3, 10.7}) > 0.5);  // a fin beyond the edge
  CHECK(onCube.heightAt({0, 0, 0}) < -8);
}

TEST_CASE("the height of a noisy surface is that of its highest point nearby") {
  Edited edited(grid(41));
  for (std::size_t i = 0; i < edited.cloud.size(); ++i) edited.cloud.positions[i].z = i % 3 == 0 ? 0.8F : -0.4F;
  const EditJudge judge(edited.cloud);
  CHECK(judge.heightAt({0.5, 0.5, 0.8}) < 0.2);
  CHECK(judge.heightAt({0.5, 0.5, 1.8}) == near(1, 0.2));
}

TEST_CASE("new points outside the old surface count as growth only where the brush carves") {
  Edited edited(grid(41));
  edited.insert({0.5, 0.5, 0.4}, edited.at(0, 0));
  CHECK(edited.verdict(middleTool(true)).broken(true) == Words{});
  edited.insert({2.5, 0.5, 1.2}, edited.at(0, 0));
  const EditVerdict verdict = edited.verdict(middleTool(true));
  CHECK(verdict.outside == 1);
  CHECK(verdict.farthestOutside == near(0.3, 1e-6));
  CHECK(verdict.broken(true) == Words{});  // one is tolerated
  CHECK(verdict.broken(true, true) == Words{"grows"});
  edited.insert({1.5, 1.5, 1.2}, edited.at(0, 0));
  CHECK(edited.verdict(middleTool(true)).broken(true) == Words{"grows"});
  CHECK(edited.verdict(middleTool(true)).broken(false) == Words{});
}

TEST_CASE("a wall between roof and floor is not outside, and points that grow out of the roof are") {
  // The floor is farther from the roof than the spacing: no path connects them.
  Edited edited(grid(41, 0.5));
  PointCloud& cloud = edited.cloud;
  const std::size_t roof = cloud.size();
  for (std::size_t i = 0; i < roof; ++i) {
    cloud.positions.push_back(cloud.positions[i] - Vec3(0, 0, 5));
    cloud.normals.push_back(cloud.normals[i]);
  }
  edited.states = statesOf(cloud);
  const BrushPath way{.centers = {DVec3(0, 0, -1)}, .radius = 3, .support = 2, .carves = true};
  for (double angle = 0; angle < 6; angle += 0.5)
    edited.insert(DVec3(2.5 * std::cos(angle), 2.5 * std::sin(angle), -2.66), edited.at(3, 0));
  CHECK(edited.verdict(way).outside == 0);
  edited.insert({3, 0.2, 1}, edited.at(3, 0));
  CHECK(edited.verdict(way).outside == 1);
}

TEST_CASE("normals are compared with a fit of their own sheet, and those that face inwards are counted") {
  Edited edited(makePlate(20'000, 0.8));
  std::vector<std::uint32_t> middle;
  for (std::uint32_t i = 0; i < edited.cloud.size(); ++i)
    if (glm::length(DVec3(edited.cloud.positions[i])) < 2.5) middle.push_back(i);
  REQUIRE(middle.size() > 20);
  for (const std::uint32_t i : middle) edited.states[i].position.z -= 0.05F;
  CHECK(edited.verdict().normal_deg < 3);
  CHECK(edited.verdict().sided == middle.size());
  CHECK(edited.verdict().turned == 0);
  CHECK(edited.verdict().broken(false) == Words{});

  for (const std::uint32_t i : middle)
    edited.states[i].normal = Vec3(0, std::sin(0.5), edited.states[i].normal.z > 0 ? std::cos(0.5) : -std::cos(0.5));
  CHECK(edited.verdict().normal_deg == near(28.6, 0.1));

  for (const std::uint32_t i : middle) edited.states[i].normal = Vec3(0, 0, 1);  // the lower sheet's face inwards
  CHECK(edited.verdict().turned == near(0.5 * static_cast<double>(middle.size()), 0.2));
  CHECK(edited.verdict().broken(false) == Words{"turns normals"});
}

TEST_CASE("two sides of a thin part that move together do not count as a second layer, a folded flap does") {
  Edited edited(makePlate(20'000, 0.1));
  std::vector<std::uint32_t> middle;
  for (std::uint32_t i = 0; i < edited.cloud.size(); ++i)
    if (glm::length(DVec3(edited.cloud.positions[i])) < 2.5) middle.push_back(i);
  for (const std::uint32_t i : middle) edited.states[i].position.z += 0.5F;
  CHECK(edited.verdict().changed == middle.size());
  CHECK(edited.verdict().doubled == 0);
  // A flap of the upper side, turned over and laid back on it.
  for (const std::uint32_t i : middle) {
    const Vec3 place = edited.cloud.positions[i];
    if (place.x < 0 || edited.cloud.normals[i].z < 0) continue;
    edited.states[i].position.x = -place.x;
    edited.states[i].normal.z = -1;
  }
  CHECK(edited.verdict().doubled > middle.size() / 10);
}

TEST_CASE("a carved wall faces the ball, wherever its sheet faced before") {
  // A ball of radius 3 carved 5 deep into a block: the lower half of its wall is below the old surface's side.
  Edited edited(grid(61, 0.4));
  const DVec3 center(0, 0, -2);
  const PointCloud wall = sampleShape(*makeShape("sphere", 6, center), {.count = 700});
  for (std::size_t k = 0; k < wall.size(); ++k)
    if (wall.positions[k].z < -0.2F) edited.insert(DVec3(wall.positions[k]), edited.at(0, 0), -DVec3(wall.normals[k]));
  const BrushPath way{.centers = {center}, .radius = 3, .support = 4, .carves = true};
  CHECK(edited.verdict(way).sided > 400);
  CHECK(edited.verdict(way).turned == 0);
  for (std::size_t i = edited.cloud.size(); i < edited.states.size(); ++i) edited.states[i].normal *= -1;
  CHECK(edited.verdict(way).turned == edited.verdict(way).sided);
}

TEST_CASE("a ball that moves sideways lines its tunnel with the sheet ahead, and lifts the one above") {
  // Straight down into a plane until the ball is below it, then along: the tunnel's ceiling is below the plane, which
  // the ball pushes up.
  Edited edited(grid(61, 0.5));
  BrushPath way{.centers = {}, .radius = 3, .support = 2, .pushes = true};
  for (int k = 0; k <= 60; ++k) way.centers.push_back(DVec3(-8, 0, 3 - 0.1 * k));
  for (int k = 0; k <= 160; ++k) way.centers.push_back(DVec3(-8 + 0.1 * k, 0, -2.8));
  for (double x = -4; x <= 6; x += 0.5)
    for (double angle = 0; angle < 6.2; angle += 0.2) {
      const DVec3 out(0, std::cos(angle), std::sin(angle));
      edited.insert(DVec3(x, 0, -2.8) + 3.0 * out, edited.at(-8, 0), -out);
    }
  for (std::uint32_t i = 0; i < edited.cloud.size(); ++i) {
    Vec3& place = edited.states[i].position;
    if (place.x > -4 && place.x < 6 && std::abs(place.y) < 1)
      place.z = static_cast<float>(std::sqrt(9.03 - place.y * place.y) - 2.8);
  }
  const EditVerdict right = edited.verdict(way);
  CHECK(right.sided > 600);
  CHECK(right.turned == 0);
  for (std::size_t i = edited.cloud.size(); i < edited.states.size(); ++i) edited.states[i].normal *= -1;
  CHECK(edited.verdict(way).turned > 500);
}

TEST_CASE("a sheet bent over by a brush faces the bent direction") {
  // The part to the right of the centre is rolled up around a cylinder of radius 1, by three quarters of a turn.
  Edited edited(grid(61, 0.1));
  const BrushPath way{.centers = {DVec3(0)}, .radius = 6, .support = 2};
  for (std::uint32_t i = 0; i < edited.cloud.size(); ++i) {
    PointState& point = edited.states[i];
    const double angle = std::min(point.position.x, 3.0F);
    if (angle <= 0) continue;
    point.position = Vec3(std::sin(angle), point.position.y, 1 - std::cos(angle));
    point.normal = Vec3(-std::sin(angle), 0, std::cos(angle));
  }
  CHECK(edited.verdict(way).sided > 1500);
  CHECK(edited.verdict(way).turned == 0);
  for (PointState& point : edited.states)
    if (point.normal.z < 0) point.normal *= -1;
  CHECK(edited.verdict(way).turned > 500);
  CHECK(edited.verdict(way).broken(false) == Words{"turns normals"});
}

TEST_CASE("a normal tangential to its surface does not decide which side is outside") {
  Edited edited(grid(41));
  const std::uint32_t moved = edited.at(1, 0);
  edited.states[moved].position.z = -0.1F;
  edited.states[moved].normal = Vec3(0, 0, -1);
  CHECK(edited.verdict().turned == 1);
  edited.cloud.normals[moved] = Vec3(1, 0, 0.1);
  CHECK(edited.verdict().turned == 0);
}

TEST_CASE("a new point near its ancestor belongs to its sheet, and one far away to the nearest sheet") {
  Edited edited(makePlate(20'000, 0.8));
  const auto lower = static_cast<std::uint32_t>(edited.cloud.size() - 1);
  REQUIRE(edited.cloud.normals[lower].z == -1);
  edited.insert({0.3, 0.3, 0.4}, lower, {0, 0, 1});
  CHECK(edited.verdict().turned == 0);
  const DVec3 near = DVec3(edited.cloud.positions[lower]) + DVec3(0, 0, 0.8);
  edited.insert(near, lower, {0, 0, 1});
  CHECK(edited.verdict().turned == 1);
}

TEST_CASE("a flipped normal of a point at rest is reported anywhere") {
  Edited edited(grid(41));
  edited.states[edited.at(15, 15)].normal = Vec3(0, 0, -1);
  CHECK(edited.verdict().turnedAtRest == 1);
  CHECK(edited.verdict().broken(false) == Words{"turns normals at rest"});
}

}  // namespace palpate::test::edit_judge_test
