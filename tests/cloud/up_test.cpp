// Estimation of the up direction: on shapes with a known one, rotated to all six axes, and on real scans outside the
// repository.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/up.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/clock.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/ply_reader.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "tests/source_folder.hpp"

namespace palpate::test::up_test {
namespace {

/// A sequence of random numbers.
struct Dice {
  std::uint64_t seed = 7, thrown = 0;
  double operator()(double from, double to) { return from + (to - from) * randomUnit(seed, thrown++); }
};

void add(PointCloud& cloud, const DVec3& place, const DVec3& normal) {
  cloud.positions.emplace_back(place);
  cloud.normals.emplace_back(glm::normalize(normal));
}

/// A parallelogram of uniformly random points.
void addFace(PointCloud& cloud, Dice& dice, const DVec3& corner, const DVec3& a, const DVec3& b, double perArea) {
  const DVec3 across = glm::cross(a, b);
  const auto count = static_cast<int>(perArea * glm::length(across));
  for (int i = 0; i < count; ++i) add(cloud, corner + dice(0, 1) * a + dice(0, 1) * b, across);
}

void addBall(PointCloud& cloud, Dice& dice, const DVec3& center, double radius, int count) {
  for (int i = 0; i < count; ++i) {
    const double y = dice(-1, 1), angle = dice(0, 2 * std::numbers::pi), r = std::sqrt(1 - y * y);
    const DVec3 n(r * std::cos(angle), y, r * std::sin(angle));
    add(cloud, center + radius * n, n);
  }
}

// All shapes have y up.

/// A cone without its tip, on a flat base.
PointCloud statue() {
  PointCloud cloud;
  Dice dice;
  for (int i = 0; i < 20000; ++i) {
    const double t = 1 - std::sqrt(dice(0, 1)), r = 1 - 0.8 * t, angle = dice(0, 2 * std::numbers::pi);
    add(cloud, {r * std::cos(angle), 2.5 * t, r * std::sin(angle)}, {std::cos(angle), 0.3, std::sin(angle)});
  }
  for (int i = 0; i < 8000; ++i) {
    const double r = std::sqrt(dice(0, 1)), angle = dice(0, 2 * std::numbers::pi);
    add(cloud, {r * std::cos(angle), 0, r * std::sin(angle)}, {0, -1, 0});
  }
  return cloud;
}

/// An animal on four legs, with a head on a long neck in front of them.
PointCloud beast() {
  PointCloud cloud;
  Dice dice;
  for (int k = 0; k < 10; ++k) addBall(cloud, dice, {-0.9 + 0.2 * k, 1.8, 0}, 0.6, 2000);
  for (int leg = 0; leg < 4; ++leg) {
    const DVec3 foot(leg % 2 ? 0.8 : -0.8, 0, leg / 2 ? 0.3 : -0.3);
    for (int k = 0; k < 2000; ++k) {
      const double angle = dice(0, 2 * std::numbers::pi), r = 0.15 * std::sqrt(dice(0, 1));
      const DVec3 around(std::cos(angle), 0, std::sin(angle));
      if (k % 8)
        add(cloud, foot + 0.15 * around + DVec3(0, dice(0, 1.4), 0), around);
      else
        add(cloud, foot + r * around, {0, -1, 0});
    }
  }
  for (int k = 0; k < 8; ++k) addBall(cloud, dice, {1 + 0.08 * k, 1.8 + 0.1 * k, 0}, 0.18, 400);
  return cloud;
}

/// A floor with boxes and balls on it, seen from above.
PointCloud thingsOnFloor() {
  PointCloud cloud;
  Dice dice;
  addFace(cloud, dice, {0, 0, 0}, {0, 0, 4}, {5, 0, 0}, 1000);
  addBall(cloud, dice, {1, 0.5, 1}, 0.5, 3000);
  addBall(cloud, dice, {3.5, 1.2, 2.5}, 1.2, 9000);
  addFace(cloud, dice, {1, 1.5, 2.5}, {0, 0, 1}, {1, 0, 0}, 1000);
  addFace(cloud, dice, {1, 0, 3.5}, {1, 0, 0}, {0, 1.5, 0}, 1000);
  addFace(cloud, dice, {1, 0, 2.5}, {0, 1.5, 0}, {1, 0, 0}, 1000);
  return cloud;
}

/// Hills, seen from above.
PointCloud terrain() {
  PointCloud cloud;
  Dice dice;
  for (int i = 0; i < 30000; ++i) {
    const double x = dice(0, 10), z = dice(0, 8);
    const DVec3 slope(0.32 * std::cos(0.8 * x) * std::sin(1.1 * z), -1, 0.44 * std::sin(0.8 * x) * std::cos(1.1 * z));
    add(cloud, {x, 0.4 * std::sin(0.8 * x) * std::sin(1.1 * z), z}, -slope);
  }
  return cloud;
}

/// Walls and a gable roof; the floor was not scanned.
PointCloud building() {
  PointCloud cloud;
  Dice dice;
  addFace(cloud, dice, {0, 0, 0}, {0, 3, 0}, {10, 0, 0}, 300);
  addFace(cloud, dice, {0, 0, 4}, {10, 0, 0}, {0, 3, 0}, 300);
  addFace(cloud, dice, {0, 0, 0}, {0, 0, 4}, {0, 3, 0}, 300);
  addFace(cloud, dice, {10, 0, 0}, {0, 3, 0}, {0, 0, 4}, 300);
  addFace(cloud, dice, {0, 3, 0}, {0, 1.5, 2}, {10, 0, 0}, 300);
  addFace(cloud, dice, {0, 3, 4}, {10, 0, 0}, {0, 1.5, -2}, 300);
  return cloud;
}

/// A head, flat at its back and sides, hollow, with an open neck that contains a windpipe and a spine.
PointCloud headCutAtNeck() {
  PointCloud cloud;
  Dice dice;
  const auto addTube = [&](const DVec3& foot, double radius, double height, int count) {
    for (int i = 0; i < count; ++i) {
      const double angle = dice(0, 2 * std::numbers::pi);
      const DVec3 out(std::cos(angle), 0, std::sin(angle));
      add(cloud, foot + radius * out + DVec3(0, dice(0, height), 0), out);
    }
  };
  addTube({0, 0, 0}, 0.55, 0.8, 6000);
  addTube({0, 0, 0.3}, 0.12, 0.8, 1300);
  addTube({0, 0, -0.25}, 0.18, 1.0, 2200);
  for (int i = 0; i < 30000; ++i) {
    const double y = dice(-1, 1), angle = dice(0, 2 * std::numbers::pi), r = std::sqrt(1 - y * y);
    DVec3 n(r * std::cos(angle), y, r * std::sin(angle));
    DVec3 p(0.8 * n.x, 1.7 + 1.0 * n.y, n.z);
    if (p.y < 0.8 && std::hypot(p.x, p.z) < 0.55) continue;
    if (p.z < -0.7) {
      p.z = -0.7;
      n = {0, 0, -1};
    }
    if (std::abs(p.x) > 0.6) {
      n = {std::copysign(1, p.x), 0, 0};
      p.x = 0.6 * n.x;
    }
    add(cloud, p, n);
  }
  return cloud;
}

/// Roofs of houses as high as their distance, trees, and the ground between them, from straight above.
PointCloud townFromTheAir(double width, double length) {
  PointCloud cloud;
  Dice dice;
  for (int i = 0; i < 40000; ++i) {
    const double x = dice(0, width), z = dice(0, length);
    const int house = static_cast<int>(x / 20) * 7 + static_cast<int>(z / 20) * 13;
    const double inX = std::fmod(x, 20.0), inZ = std::fmod(z, 20.0);
    const bool isRoof = inX > 10 && inZ > 8;
    const bool isTree = !isRoof && std::hypot(inX - 5, inZ - 4) < 3;
    const double height = isRoof ? 14 + 4 * (house % 5) : isTree && dice(0, 1) < 0.6 ? dice(3, 9) : 0.02 * x;
    add(cloud, {x, height, z}, {-0.02, 1, 0});
  }
  return cloud;
}

/// A corner of a room with a cupboard, a bed and a lamp, seen by a camera at the opposite end: y up, the camera at +z.
PointCloud roomFromOneSide() {
  PointCloud cloud;
  Dice dice;
  addFace(cloud, dice, {0, 0, 0}, {0, 0, 1.7}, {4, 0, 0}, 1500);
  addFace(cloud, dice, {0, 0, 0}, {4, 0, 0}, {0, 2.5, 0}, 1500);
  addFace(cloud, dice, {0, 0.8, 0}, {0, 1.7, 0}, {0, 0, 1.4}, 800);
  addFace(cloud, dice, {2.5, 0, 0.6}, {1, 0, 0}, {0, 1.9, 0}, 1500);
  addFace(cloud, dice, {0.5, 0.5, 0.3}, {0, 0, 1.2}, {1.5, 0, 0}, 1500);
  addFace(cloud, dice, {0.5, 0, 1.5}, {1.5, 0, 0}, {0, 0.5, 0}, 1500);
  addBall(cloud, dice, {2.2, 1.2, 1}, 0.15, 300);
  return cloud;
}

/// A room with its ceiling and four walls, a bed, a table and a shelf, all seen from inside.
PointCloud roomFromWithin() {
  PointCloud cloud;
  Dice dice;
  addFace(cloud, dice, {0, 0, 0}, {0, 0, 4}, {5, 0, 0}, 500);
  addFace(cloud, dice, {0, 2.5, 0}, {5, 0, 0}, {0, 0, 4}, 500);
  addFace(cloud, dice, {0, 0, 0}, {5, 0, 0}, {0, 2.5, 0}, 500);
  addFace(cloud, dice, {0, 0, 4}, {0, 2.5, 0}, {5, 0, 0}, 500);
  addFace(cloud, dice, {0, 0, 0}, {0, 2.5, 0}, {0, 0, 4}, 500);
  addFace(cloud, dice, {5, 0, 0}, {0, 0, 4}, {0, 2.5, 0}, 500);
  const auto addBox = [&](const DVec3& low, const DVec3& size) {
    addFace(cloud, dice, low + DVec3(0, size.y, 0), {0, 0, size.z}, {size.x, 0, 0}, 500);
    addFace(cloud, dice, low + DVec3(0, 0, size.z), {size.x, 0, 0}, {0, size.y, 0}, 500);
    addFace(cloud, dice, low + DVec3(size.x, 0, 0), {0, size.y, 0}, {0, 0, size.z}, 500);
  };
  addBox({0, 0, 0}, {2, 0.5, 1.4});
  addBox({3, 0.7, 1.5}, {1.5, 0.1, 1});
  addBox({4, 0, 0}, {0.5, 1.3, 0.4});
  return cloud;
}

struct Named {
  std::string_view name;
  std::function<PointCloud()> make;
};
const Named kStanding[] = {{"statue", statue},
                           {"beast", beast},
                           {"things on a floor", thingsOnFloor},
                           {"terrain", terrain},
                           {"building", building}};

/// Rotates a cloud with y up and its front at +z.
PointCloud turned(PointCloud cloud, UpAxis up) {
  const DVec3 y = directionOf(up), z = frontOf(up), x = glm::cross(y, z);
  const auto turn = [&](Vec3& v) { v = Vec3(double{v.x} * x + double{v.y} * y + double{v.z} * z); };
  for (Vec3& p : cloud.positions) turn(p);
  for (Vec3& n : cloud.normals) turn(n);
  return cloud;
}

/// The points between two fractions of the longest side.
PointCloud sliceOf(const PointCloud& cloud, double from, double to) {
  const Bounds box = boundsOf(cloud);
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (box.max[k] - box.min[k] > box.max[axis] - box.min[axis]) axis = k;
  PointCloud slice;
  for (const Vec3& p : cloud.positions) {
    const double along = (double{p[axis]} - box.min[axis]) / (box.max[axis] - box.min[axis]);
    if (along >= from && along <= to) slice.positions.push_back(p);
  }
  return slice;
}

/// The points of a depth image, with the camera at the origin, y down and z ahead. Normals from neighbouring pixels.
PointCloud viewOf(const DepthFrame& frame, const DepthCamera& camera, bool withNormals) {
  PointCloud cloud;
  const auto place = [&](unsigned x, unsigned y) {
    const double depth = frame.depth_m[std::size_t{y} * camera.width + x];
    return depth * DVec3((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
  };
  for (unsigned y = 0; y + 3 < camera.height; y += 3)
    for (unsigned x = 0; x + 3 < camera.width; x += 3) {
      const DVec3 p = place(x, y), across = place(x + 3, y) - p, down = place(x, y + 3) - p;
      if (!(p.z > 0) || std::max(std::abs(across.z), std::abs(down.z)) > 0.05 * p.z) continue;
      cloud.positions.emplace_back(p);
      if (withNormals) cloud.normals.emplace_back(glm::normalize(glm::cross(down, across)));
    }
  return cloud;
}

void addOutliers(PointCloud& cloud, double share, double far) {
  Dice dice{.seed = 99};
  const Bounds box = boundsOf(cloud);
  const DVec3 half = DVec3(far * box.longestSide());
  const auto count = static_cast<std::size_t>(share * static_cast<double>(cloud.size()));
  for (std::size_t i = 0; i < count; ++i)
    add(cloud, box.center() + DVec3(dice(-1, 1), dice(-1, 1), dice(-1, 1)) * half, {0, 1, 0});
}

}  // namespace

TEST_CASE("front and up are axes of a right-handed frame") {
  for (const auto& [name, up] : kUpAxes) {
    CAPTURE(name);
    CHECK(nameOf(up) == name);
    CHECK(glm::dot(directionOf(up), frontOf(up)) == 0);
    CHECK(glm::length(frontOf(up)) == 1);
    CHECK(directionOf(up)[name.back() - 'x'] == (name.front() == '-' ? -1 : 1));
  }
  CHECK(frontOf(UpAxis::y) == DVec3(0, 0, 1));
}

TEST_CASE("standing and flat models get the right up axis in any orientation of the file") {
  for (const auto& [name, make] : kStanding)
    for (const auto& [upName, up] : kUpAxes) {
      CAPTURE(name);
      CAPTURE(upName);
      PointCloud cloud = turned(make(), up);
      const Upright found = findUp(cloud);
      CAPTURE(found.why);
      CHECK(nameOf(found.up) == upName);
      CHECK(!found.why.empty());
      cloud.normals.clear();
      // Without normals it is unknown from which side ground was seen, and that a floor was not.
      if (name != "terrain" && name != "building") CHECK(nameOf(findUp(cloud).up) == upName);
    }
}

TEST_CASE("outliers and uneven sampling do not turn a model over") {
  for (const auto& [name, make] : kStanding)
    for (const auto& [upName, up] : kUpAxes)
      for (const double far : {0.7, 40.0}) {
        CAPTURE(name);
        CAPTURE(upName);
        CAPTURE(far);
        PointCloud cloud = turned(make(), up);
        addOutliers(cloud, 0.01, far);
        CHECK(nameOf(findUp(cloud).up) == upName);
        // The density falls to a tenth from one end to the other.
        const PointCloud all = cloud;
        const Bounds box = boundsOf(turned(make(), up));
        cloud.positions.clear();
        cloud.normals.clear();
        Dice dice{.seed = 5};
        for (std::size_t i = 0; i < all.size(); ++i) {
          const double along = (double{all.positions[i].x} - box.min.x) / (box.max.x - box.min.x);
          if (dice(0, 1) < 0.1 + 0.9 * along) add(cloud, DVec3(all.positions[i]), DVec3(all.normals[i]));
        }
        CHECK(nameOf(findUp(cloud).up) == upName);
      }
}

TEST_CASE("ambiguous shapes have y up") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(name);
    const auto shape = makeShape(name, 100, DVec3(3, -8, 20));
    for (const std::size_t count : {2000, 60000}) {
      CAPTURE(count);
      const Upright found = findUp(sampleShape(*shape, {.count = count}));
      CAPTURE(found.why);
      CHECK(found.up == UpAxis::y);
    }
  }
  CHECK(findUp(PointCloud{}).up == UpAxis::y);
  PointCloud said;
  said.storedAs.comments = {"comment turned up: z", "comment up: -z"};
  CHECK(findUp(said).up == UpAxis::minusZ);
  PointCloud few;
  Dice dice;
  addFace(few, dice, DVec3(0), {0, 0, 5}, {2, 0, 0}, 2);
  CHECK(findUp(few).up == UpAxis::y);
  PointCloud same;
  for (int i = 0; i < 1000; ++i) add(same, {1, 2, 3}, {0, 0, 1});
  CHECK(findUp(same).up == UpAxis::y);
}

TEST_CASE("a wall with windows counts as standing, not as ground") {
  PointCloud wall;  // y up, seen from +z
  Dice dice;
  for (int column = 0; column < 6; ++column)
    for (int row = 0; row < 4; ++row) {
      const DVec3 at(2.0 * column, 2.0 * row, 0);
      for (const DVec3& pillar : {at, at + DVec3(1, 0, 0)}) addFace(wall, dice, pillar, {1, 0, 0}, {0, 1, 0}, 400);
      addFace(wall, dice, at + DVec3(0, 1, 0), {1, 0, 0}, {0, 1, 0}, 400);
      const DVec3 window = at + DVec3(1, 1, -0.6);
      addFace(wall, dice, window, {1, 0, 0}, {0, 1, 0}, 400);
      addFace(wall, dice, window, {0, 1, 0}, {0, 0, 0.6}, 400);
      addFace(wall, dice, window + DVec3(1, 0, 0), {0, 0, 0.6}, {0, 1, 0}, 400);
      addFace(wall, dice, window, {0, 0, 0.6}, {1, 0, 0}, 400);
    }
  CHECK(findUp(wall).up == UpAxis::y);
  CHECK(findUp(turned(wall, UpAxis::z)).up == UpAxis::z);
}

TEST_CASE("a head cut off at the neck stands on the cut, and not on a flat side") {
  for (const auto& [name, up] : kUpAxes) {
    CAPTURE(name);
    PointCloud head = turned(headCutAtNeck(), up);
    Upright found = findUp(head);
    CAPTURE(found.why);
    CHECK(nameOf(found.up) == name);
    head.normals.clear();
    found = findUp(head);
    CAPTURE(found.why);
    CHECK(nameOf(found.up) == name);
  }
}

TEST_CASE("a head cut off at neck and crown, from a volume, has z up") {
  const PointCloud whole = turned(headCutAtNeck(), UpAxis::z);
  PointCloud cut;
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (whole.positions[i].z < 2.2f) add(cut, DVec3(whole.positions[i]), DVec3(whole.normals[i]));
  CHECK(nameOf(findUp(cut).up) == "z");
  cut.normals.clear();
  CHECK(nameOf(findUp(cut).up) == "z");
}

TEST_CASE("aerial scans of towns, also in narrow strips, have up across the ground") {
  for (const auto& [width, length] : {std::pair{80.0, 60.0}, {80.0, 25.0}, {40.0, 40.0}}) {
    CAPTURE(width);
    CAPTURE(length);
    for (const auto& [name, up] : kUpAxes) {
      CAPTURE(name);
      const Upright found = findUp(turned(townFromTheAir(width, length), up));
      CAPTURE(found.why);
      CHECK(nameOf(found.up) == name);
    }
    PointCloud bare = turned(townFromTheAir(width, length), UpAxis::z);
    bare.normals.clear();
    CHECK(nameOf(findUp(bare).up) == "z");
  }
}

TEST_CASE("a room scanned from one side stands on its floor") {
  for (const auto& [name, up] : kUpAxes) {
    CAPTURE(name);
    if (name.ends_with('x')) continue;  // a wall beside the view is more likely than a file with x up
    const Upright found = findUp(turned(roomFromOneSide(), up));
    CAPTURE(found.why);
    CHECK(nameOf(found.up) == name);
  }
}

TEST_CASE("a room scanned from within stands on the floor, from which its furniture rises") {
  for (const auto& [name, up] : kUpAxes) {
    CAPTURE(name);
    const Upright found = findUp(turned(roomFromWithin(), up));
    CAPTURE(found.why);
    CHECK(nameOf(found.up) == name);
  }
}

TEST_CASE("a view from the origin along z has y down") {
  PointCloud view;
  const PointCloud room = turned(roomFromOneSide(), UpAxis::minusY);  // seen along z, as by a camera
  for (const Vec3& p : room.positions) {
    const Vec3 seen = p + Vec3(-2, 1.2f, 3.6f);  // moves the centre of the room onto the axis
    if (std::abs(seen.x) < 0.8f * seen.z && std::abs(seen.y) < 0.6f * seen.z) view.positions.push_back(seen);
  }
  Upright found = findUp(view);
  CAPTURE(found.why);
  CHECK(nameOf(found.up) == "-y");
  for (Vec3& p : view.positions) p = Vec3(p.x, -p.y, -p.z);
  found = findUp(view);
  CAPTURE(found.why);
  CHECK(nameOf(found.up) == "y");
}

TEST_CASE("each picture of a real depth camera has y down") {
  const std::filesystem::path folder = modelsFolder() / "rgbd_livingroom_a";
  if (!isRgbdFolder(folder)) {
    MESSAGE("skipped: no ", folder.string());
    return;
  }
  RgbdFolder stream(folder);
  DepthFrame frame;
  for (std::uint64_t i = 0; i < stream.frames(); i += 6) {
    CAPTURE(i);
    stream.rewind();
    for (std::uint64_t k = 0; k <= i; ++k) REQUIRE(stream.next(frame));
    PointCloud cloud = viewOf(frame, stream.camera(), false);
    Upright found = findUp(cloud);
    CAPTURE(found.why);
    CHECK(nameOf(found.up) == "-y");
    // With normals a floor is sufficient, wherever the origin is.
    cloud = viewOf(frame, stream.camera(), true);
    for (Vec3& p : cloud.positions) p += Vec3(-5, 3, -2);
    found = findUp(cloud);
    CAPTURE(found.why);
    CHECK(nameOf(found.up) == "-y");
  }
}

TEST_CASE("strips of a real aerial scan have z up, without any hint in the file") {
  const std::filesystem::path file = modelsFolder() / "formats" / "autzen_trim.laz";
  if (!std::filesystem::exists(file)) {
    MESSAGE("skipped: no ", file.string());
    return;
  }
  const PointCloud cloud = readCloud(file).cloud;
  constexpr int kStrips = 12;
  for (int i = 0; i < kStrips; ++i) {
    CAPTURE(i);
    const PointCloud strip = sliceOf(cloud, i / double{kStrips}, (i + 1) / double{kStrips});
    const Upright found = findUp(strip);
    CAPTURE(found.why);
    CHECK((strip.size() < 1000 || nameOf(found.up) == "z"));
  }
}

TEST_CASE("a few distant points do not widen the shown box") {
  for (const auto& [name, make] : kStanding) {
    CAPTURE(name);
    PointCloud cloud = make();
    const Bounds box = boundsOf(cloud);
    const Bounds whole = coreBoundsOf(cloud);
    CHECK(whole.min == box.min);
    CHECK(whole.max == box.max);
    addOutliers(cloud, 0.002, 30);
    const Bounds core = coreBoundsOf(cloud);
    CHECK(core.longestSide() < 1.2 * box.longestSide());
    for (int k = 0; k < 3; ++k) {
      CHECK(core.min[k] <= box.min[k]);
      CHECK(core.max[k] >= box.max[k]);
    }
  }
  // A group of many points is part of the model.
  PointCloud two = statue();
  const std::size_t count = two.size();
  for (std::size_t i = 0; i < count / 10; ++i) add(two, DVec3(two.positions[10 * i]) + DVec3(60, 0, 0), {0, 1, 0});
  CHECK(coreBoundsOf(two).max == boundsOf(two).max);
}

TEST_CASE("real scans stand upright in any orientation of the file") {
  const std::pair<std::string_view, UpAxis> kTruth[] = {{"armadillo_43243.ply", UpAxis::y},
                                                        {"armadillo_1037774.ply", UpAxis::y},
                                                        {"bunny_34834.ply", UpAxis::y},
                                                        {"bunny_208347.ply", UpAxis::y},
                                                        {"bunny_mesh_69451.ply", UpAxis::y},
                                                        {"dragon_437645.ply", UpAxis::y},
                                                        {"dragon_res3.ply", UpAxis::y},
                                                        {"building_100000.ply", UpAxis::z},
                                                        {"horse_48485.ply", UpAxis::z},
                                                        {"lion_takanawa_341989.ply", UpAxis::z},
                                                        {"pond_pmvs_70051.ply", UpAxis::minusY},
                                                        {"wild/opencv__ape.ply", UpAxis::minusZ},
                                                        {"wild/trimesh__fuze_ascii.ply", UpAxis::z},
                                                        {"wild/tinyply__elephant.ply", UpAxis::y},
                                                        {"wild/vtkdata__shark.ply", UpAxis::y}};
  if (!std::filesystem::exists(modelsFolder())) {
    MESSAGE("skipped: no ", modelsFolder().string());
    return;
  }
  for (const auto& [file, up] : kTruth) {
    CAPTURE(file);
    const PointCloud cloud = readPly(modelsFolder() / file);
    const Stopwatch watch;
    const Upright found = findUp(cloud);
    MESSAGE(file, ": ", nameOf(found.up), ", ", found.why, ", ", watch.elapsed_us() * 1e-3, " ms");
    CHECK(nameOf(found.up) == nameOf(up));
    if (file == "wild/vtkdata__shark.ply") continue;  // it swims: nothing indicates up, so y is the default
    for (const auto& [name, to] : kUpAxes) {
      CAPTURE(name);
      const DVec3 expected = turned(PointCloud{.positions = {Vec3(directionOf(up))}}, to).positions.front();
      CHECK(directionOf(findUp(turned(cloud, to)).up) == expected);
    }
  }
}

}  // namespace palpate::test::up_test
