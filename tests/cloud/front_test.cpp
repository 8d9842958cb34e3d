#include <doctest/doctest.h>

#include "engine/cloud/up.hpp"
#include "engine/io/ply_reader.hpp"
#include "tests/cloud/upright_shapes.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test::front_test {

using namespace upright;

namespace {

/// The axis of a front at +z after headed().
UpAxis frontAfter(int quarters) {
  constexpr std::array kFronts{UpAxis::z, UpAxis::x, UpAxis::minusZ, UpAxis::minusX};
  return kFronts[static_cast<std::size_t>(quarters)];
}

/// Half of a ball on a plinth, seen from +z and open behind, as a scan from one side.
PointCloud bust() {
  PointCloud cloud;
  Dice dice;
  addBall(cloud, dice, {0, 2, 0}, 1, 40000);
  PointCloud half;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].z > 0.3f * std::sin(3 * cloud.positions[i].y))
      add(half, DVec3(cloud.positions[i]), DVec3(cloud.normals[i]));
  addFace(half, dice, {-0.8, 0, 0.8}, {1.6, 0, 0}, {0, 1.2, 0}, 6000);
  addFace(half, dice, {0.8, 0, 0.8}, {0, 0, -0.8}, {0, 1.2, 0}, 6000);
  addFace(half, dice, {-0.8, 0, 0}, {0, 0, 0.8}, {0, 1.2, 0}, 6000);
  addFace(half, dice, {-0.8, 0, 0}, {1.6, 0, 0}, {0, 0, 0.8}, 6000);
  return half;
}

/// A wide slab on a plinth, carved at the front alone.
PointCloud relief() {
  PointCloud cloud;
  Dice dice;
  for (int i = 0; i < 30000; ++i) {
    const double x = dice(-1, 1), y = dice(0, 3);
    add(cloud, {x, y, 0.4 + 0.05 * std::sin(9 * x) * std::sin(9 * y)},
        {-0.45 * std::cos(9 * x) * std::sin(9 * y), -0.45 * std::sin(9 * x) * std::cos(9 * y), 1});
  }
  addFace(cloud, dice, {-1, 0, -0.4}, {0, 3, 0}, {2, 0, 0}, 5000);
  addFace(cloud, dice, {1, 0, 0.4}, {0, 0, -0.8}, {0, 3, 0}, 5000);
  addFace(cloud, dice, {-1, 0, -0.4}, {0, 0, 0.8}, {0, 3, 0}, 5000);
  addFace(cloud, dice, {-1.2, -0.3, -0.7}, {2.4, 0, 0}, {0, 0, 1.4}, 5000);
  addFace(cloud, dice, {-1.2, -0.3, 0.7}, {2.4, 0, 0}, {0, 0.3, 0}, 5000);
  addFace(cloud, dice, {1.2, -0.3, -0.7}, {-2.4, 0, 0}, {0, 0.3, 0}, 5000);
  return cloud;
}

}  // namespace

TEST_CASE("a skull without a base stands upright in any orientation of the file, and is said to be guessed") {
  for (const auto& [name, up] : kUpAxes)
    for (int quarters = 0; quarters < 4; ++quarters) {
      CAPTURE(name);
      CAPTURE(quarters);
      const Upright found = findUp(turned(headed(skull(), quarters), up));
      CAPTURE(found.why);
      CHECK(nameOf(found.up) == name);
      CHECK(found.sureness == Sureness::guessed);
    }
}

TEST_CASE("the first view shows the outer side of an open scan, and the detailed one of two wide sides") {
  for (const auto& make : {bust, relief})
    for (int quarters = 0; quarters < 4; ++quarters) {
      CAPTURE(quarters);
      CAPTURE((make == relief));
      const Upright found = findUp(headed(make(), quarters));
      CHECK(nameOf(found.up) == "y");
      CHECK(nameOf(axisOf(found.front)) == nameOf(frontAfter(quarters)));
      CHECK(found.frontSureness == Sureness::likely);
    }
}

TEST_CASE("the front is level, along an axis, and guessed where all sides are alike") {
  for (const auto& [name, make] : kStanding)
    for (const auto& [upName, up] : kUpAxes) {
      CAPTURE(name);
      CAPTURE(upName);
      const Upright found = findUp(turned(make(), up));
      CHECK(glm::dot(found.front, directionOf(found.up)) == 0);
      CHECK(directionOf(axisOf(found.front)) == found.front);
      CHECK(found.frontFor(found.up) == found.front);
      for (const auto& [otherName, other] : kUpAxes)
        if (other != found.up) CHECK(found.frontFor(other) == frontOf(other));
    }
  const Upright round = findUp(statue());
  CHECK(round.front == DVec3(0, 0, 1));
  CHECK(round.frontSureness == Sureness::guessed);
  PointCloud said = statue();
  said.storedAs.comments = {"comment up: z"};
  CHECK(findUp(said).sureness == Sureness::known);
  CHECK(findUp(said).front == frontOf(UpAxis::z));
}

TEST_CASE("a model turns by 90 degrees about its front, and after four turns stands as before") {
  for (const auto& [name, up] : kUpAxes) {
    CAPTURE(name);
    const DVec3 front = frontOf(up), right = glm::cross(directionOf(up), front);
    UpAxis turned = up;
    for (int k = 0; k < 4; ++k) {
      const DVec3 before = directionOf(turned);
      turned = turnedUp(turned, front);
      CHECK(glm::dot(before, directionOf(turned)) == 0);
      CHECK(glm::dot(front, directionOf(turned)) == 0);
      if (k == 0) CHECK(directionOf(turned) == -right);  // what was at the left is above
    }
    CHECK(turned == up);
  }
}

TEST_CASE("real scans face the viewer in any heading of the file") {
  const std::pair<std::string_view, UpAxis> kTruth[] = {{"armadillo_43243.ply", UpAxis::z},
                                                        {"armadillo_1037774.ply", UpAxis::z},
                                                        {"building_100000.ply", UpAxis::minusX},
                                                        {"lion_takanawa_341989.ply", UpAxis::minusY}};
  for (const auto& [file, front] : kTruth) {
    CAPTURE(file);
    const std::filesystem::path path = sharedFile(file);
    if (path.empty()) return;
    PointCloud cloud = readPly(path);
    const UpAxis up = findUp(cloud).up;
    DVec3 expected = directionOf(front);
    for (int quarters = 0; quarters < 4; ++quarters) {
      CAPTURE(quarters);
      const Upright found = findUp(cloud);
      CHECK(found.up == up);
      CHECK(found.front == expected);
      const auto turn = [&](const auto& v) {
        return directionOf(up) * glm::dot(directionOf(up), DVec3(v)) + glm::cross(directionOf(up), DVec3(v));
      };
      for (Vec3& p : cloud.positions) p = Vec3(turn(p));
      for (Vec3& n : cloud.normals) n = Vec3(turn(n));
      expected = turn(expected);
    }
  }
}

}  // namespace palpate::test::front_test
