// Filled scans, and the points that deform with them.
#include <cmath>
#include <cstdio>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/matter/soft_scan.hpp"
#include "engine/matter/soft_world.hpp"
#include "tests/error_of.hpp"
#include "tests/matter/matter_scenes.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::soft_scan_test {

namespace {

constexpr double kPi = 3.14159265358979323846;

MatterScene scanScene() {
  return {.matter = Matter::soft, .box_mm = {140, 140, 140}, .fill_mm = {100, 100, 100}, .spacing_mm = 5};
}

PointCloud shapeCloud(std::string_view shape, std::size_t points = 20000) {
  return sampleShape(*makeShape(shape), {.count = points});
}

std::string fillRefusal(const PointCloud& cloud, const MatterScene& scene = scanScene()) {
  return errorOf([&] {
    WorkerTeam team(2);
    scanSolid(placeScan(cloud, scene), scene.spacing_mm * 1e-3, scene.hole_mm * 1e-3, team);
  });
}

// The points for which `goes` is false.
PointCloud without(const PointCloud& cloud, auto goes) {
  PointCloud left;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (goes(cloud.positions[i])) continue;
    left.positions.push_back(cloud.positions[i]);
    left.normals.push_back(cloud.normals[i]);
  }
  return left;
}

}  // namespace

TEST_CASE("the winding number of a sphere of points is 1 inside and 0 outside, and half of that for half a sphere") {
  const PointCloud cloud = shapeCloud("sphere", 5000);  // radius 50
  const auto areas = [&](auto keeps) {
    std::vector<OrientedArea> points;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (keeps(cloud.positions[i]))
        points.push_back({cloud.positions[i], cloud.normals[i], static_cast<float>(4 * kPi * 2500 / 5000)});
    return points;
  };
  const WindingNumber whole(areas([](const Vec3&) { return true; }));
  const WindingNumber half(areas([](const Vec3& place) { return place.z > 0; }));
  for (const DVec3& place : {DVec3(0), DVec3(30, 10, -5), DVec3(0, 0, 45), DVec3(-20, -30, 20)})
    CHECK(std::abs(whole.at(place) - 1) < 0.03);
  for (const DVec3& place : {DVec3(60, 0, 0), DVec3(30, 40, -25), DVec3(0, 0, 55), DVec3(-200, 30, 20)})
    CHECK(std::abs(whole.at(place)) < 0.03);
  CHECK(std::abs(half.at(DVec3(0)) - 0.5) < 0.02);
  CHECK(WindingNumber({}).at(DVec3(0)) == 0);
}

TEST_CASE("a closed scan is filled with its volume") {
  WorkerTeam team(2);
  struct Case {
    std::string_view shape;
    double volume_m3, share;
  };
  for (const Case& one : {Case{"sphere", 4 * kPi / 3 * std::pow(0.05, 3), 0.02}, Case{"cube", 1e-3, 0.03},
                          Case{"torus", 2 * kPi * kPi * 0.035 * 0.015 * 0.015, 0.04}}) {
    CAPTURE(one.shape);
    const auto points = placeScan(shapeCloud(one.shape), scanScene());
    const SoftSolid solid = scanSolid(points, 0.005, 0, team);
    CHECK(isWithin(one.share, solid.lattice.volume_m3(), one.volume_m3));
    // The stiff volume is hardly larger.
    double stiff_m3 = 0;
    for (const float filled : solid.lattice.filled()) stiff_m3 += std::pow(0.005, 3) * static_cast<double>(filled);
    CHECK(isWithin(0.1, stiff_m3, one.volume_m3));
    // Every point is in a cell of the body.
    for (const SurfacePlace& point : points) {
      const EmbeddedPlace place = solid.lattice.embed(DVec3(point.rest));
      for (int axis = 0; axis < 3; ++axis) {
        REQUIRE(place.share[axis] >= 0);
        REQUIRE(place.share[axis] <= 1);
      }
    }
  }
}

TEST_CASE("a scan is filled identically by one thread and by three") {
  const auto points = placeScan(shapeCloud("sculpture", 8000), scanScene());
  WorkerTeam one(1), three(3);
  const SoftSolid a = scanSolid(points, 0.006, 0, one), b = scanSolid(points, 0.006, 0, three);
  REQUIRE(a.lattice.nodes() > 500);
  CHECK(std::ranges::equal(a.lattice.rest(), b.lattice.rest()));
  CHECK(std::ranges::equal(a.lattice.filled(), b.lattice.filled()));
}

TEST_CASE("an open scan is refused with the position and width of its hole") {
  // The sphere of 100 mm stands in the middle of the box, on the floor: its middle is at 70, 50, 70.
  const PointCloud sphere = shapeCloud("sphere");
  CHECK(fillRefusal(sphere).empty());
  const auto checkHole = [&](auto goes, double expectedWidth, const DVec3& expectedPlace) {
    const std::string text = fillRefusal(without(sphere, goes));
    double width = 0;
    DVec3 place(0);
    REQUIRE(std::sscanf(text.c_str(), "model: is not closed: there is a hole about %lf mm wide at %lf, %lf, %lf mm",
                        &width, &place.x, &place.y, &place.z) == 4);
    CHECK(isWithin(0.2, width, expectedWidth));
    CHECK(glm::length(place - expectedPlace) < 10);
  };
  checkHole([](const Vec3& place) { return place.x > 40; }, 60, {115, 50, 70});
  checkHole([](const Vec3& place) { return place.y < 0; }, 100, {70, 0, 70});
  CHECK(fillRefusal(without(sphere, [](const Vec3& place) { return place.x > 49.5; })).empty());
  MatterScene patient = scanScene();
  patient.hole_mm = 80;
  CHECK(fillRefusal(without(sphere, [](const Vec3& place) { return place.x > 40; }), patient).empty());
  patient.hole_mm = 5;
  CHECK(says(fillRefusal(without(sphere, [](const Vec3& place) { return place.x > 49.5; }), patient), "model: is not"));
}

TEST_CASE("a sheet of few uneven points is refused as open, and a closed scan of as few points is accepted") {
  // Terrain as measured from an aeroplane: height differences exceed the spacing.
  std::mt19937 random(5);
  std::uniform_real_distribution<float> side(0, 100), height(0, 12);
  PointCloud sheet;
  for (int i = 0; i < 1000; ++i) {
    const float z = side(random);
    const float low = height(random);
    const float high = height(random);
    const float x = side(random);
    sheet.positions.emplace_back(x, low + high, z);
    sheet.normals.emplace_back(0, 1, 0);
  }
  CHECK(says(fillRefusal(sheet), "model: is not closed: its points are"));
  for (Vec3& normal : sheet.normals) normal = -normal;
  CHECK(says(fillRefusal(sheet), "model: is not closed"));
  CHECK(fillRefusal(shapeCloud("sphere", 1000)).empty());
  CHECK(fillRefusal(shapeCloud("torus", 1000)).empty());
  // Half of a sphere, closed by a film on request.
  MatterScene scene = scanScene();
  scene.hole_mm = 200;
  CHECK(fillRefusal(without(shapeCloud("sphere"), [](const Vec3& place) { return place.y > 0; }), scene).empty());
}

TEST_CASE("a scan that encloses nothing, is inside out, or is too small is refused") {
  CHECK(says(fillRefusal(shapeCloud("plane")), "model: "));
  PointCloud inwards = shapeCloud("sphere");
  for (Vec3& normal : inwards.normals) normal = -normal;
  CHECK(says(fillRefusal(inwards), "model: its normals point inwards"));
  CHECK(says(fillRefusal(shapeCloud("sphere", 20)), "model: has 20 points"));
  PointCloud single;
  single.positions.assign(200, Vec3(1));
  CHECK(says(fillRefusal(single), "model: "));
}

TEST_CASE("points at rest stay bit by bit, and follow a uniform strain exactly, with their normals") {
  const auto points = placeScan(shapeCloud("sculpture", 5000), scanScene());
  WorkerTeam team(2);
  const SoftSolid solid = scanSolid(points, 0.005, 0, team);
  SoftBody body(solid.lattice, {.young_Pa = 1e4, .poisson = 0.4, .density_kg_m3 = 1000, .viscosity_Pa_s = 0}, {});
  SoftEmbedding embedding(solid.lattice, points);
  CloudFrame frame;
  embedding.carry(body, frame, team);
  for (std::size_t i = 0; i < points.size(); ++i) {
    REQUIRE(frame.positions[i] == points[i].rest);
    REQUIRE(glm::length(frame.normals[i] - points[i].normal) < 1e-6f);
    REQUIRE(frame.velocities[i] == Vec3(0));
  }
  const glm::dmat3 strain = glm::mat3_cast(glm::angleAxis(2.2, glm::normalize(DVec3(1, 3, 2)))) *
                            glm::dmat3(DVec3(1.3, 0.2, 0), DVec3(0.1, 0.8, 0.1), DVec3(0, 0, 1.1));
  const DVec3 shift(0.2, -0.1, 0.05);
  for (std::size_t i = 0; i < body.size(); ++i) {
    const DVec3 rest(solid.lattice.rest()[i]);
    body.displacements()[i] = strain * rest + shift - rest;
    body.velocities()[i] = 3.0 * rest;
  }
  embedding.carry(body, frame, team);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DVec3 rest(points[i].rest);
    REQUIRE(glm::length(DVec3(frame.positions[i]) - (strain * rest + shift)) < 1e-6);
    REQUIRE(glm::length(DVec3(frame.velocities[i]) - 3.0 * rest) < 1e-6);
    const DVec3 normal = glm::normalize(glm::transpose(glm::inverse(strain)) * DVec3(points[i].normal));
    REQUIRE(glm::length(DVec3(frame.normals[i]) - normal) < 1e-5);
  }
}

TEST_CASE("a bent bar has the normals of an arc") {
  const SoftSolid solid = boxSolid(DVec3(0), DVec3(0.1, 0.02, 0.02), 0.005);
  SoftBody body(solid.lattice, {.young_Pa = 1e4, .poisson = 0.4, .density_kg_m3 = 1000, .viscosity_Pa_s = 0}, {});
  constexpr double kRadius_m = 0.15;
  const auto bent = [](const DVec3& rest) {
    const double angle = rest.x / kRadius_m, outer = kRadius_m + rest.y - 0.01;
    return DVec3(outer * std::sin(angle), outer * std::cos(angle) - kRadius_m, rest.z);
  };
  for (std::size_t i = 0; i < body.size(); ++i) {
    const DVec3 rest(solid.lattice.rest()[i]);
    body.displacements()[i] = bent(rest) - rest;
  }
  std::vector<SurfacePlace> top;
  for (int k = 0; k < 200; ++k) top.push_back({.rest = {(k + 0.5f) * 0.0005f, 0.02f, 0.01f}, .normal = {0, 1, 0}});
  SoftEmbedding embedding(solid.lattice, top);
  WorkerTeam team(1);
  CloudFrame frame;
  embedding.carry(body, frame, team);
  for (std::size_t k = 10; k < 190; ++k) {
    const double angle = static_cast<double>(top[k].rest.x) / kRadius_m;
    CHECK(angleBetween_deg(DVec3(frame.normals[k]), DVec3(std::sin(angle), std::cos(angle), 0)) < 0.1);
    CHECK(glm::length(DVec3(frame.positions[k]) - bent(DVec3(top[k].rest))) < 3e-5);
  }
}

TEST_CASE("a scan that stands on its foot is pressed by a hand and carries its points along") {
  MatterScene scene = scanScene();
  scene.spacing_mm = 7;
  scene.young_Pa = 1e5;
  scene.viscosity_Pa_s = 20;
  scene.tool = {.radius_mm = 15, .mass_kg = 0.05};
  scene.pinned_mm = {DVec3(0), DVec3(140, 8, 140)};
  const auto points = placeScan(shapeCloud("torus", 8000), scene);
  WorkerTeam team(2);
  SoftWorld world(scene, {.tools = 1}, scanSolid(points, 0.007, 0, team), points);
  HandPose hand{.place_m = {0.07, 0.12, 0.07}};
  for (int k = 0; k < 600; ++k) {
    hand.place_m.y -= k < 300 ? 6e-5 : 0;
    world.step({&hand, 1});
  }
  REQUIRE(world.state() == MatterState::running);
  CHECK(world.answers()[0].reaction_N.y > 0.05);
  CloudFrame frame;
  world.makeFrame(frame);
  REQUIRE(frame.size() == points.size());
  CHECK(frame.time_s == near(0.6, 1e-6));
  // No point is deep inside the ball or below the floor.
  for (const Vec3& position : frame.positions) {
    REQUIRE(glm::length(DVec3(position) - world.answers()[0].place_m) > 0.013);
    REQUIRE(position.y > -1e-3f);
  }
}

}  // namespace palpate::soft_scan_test
