// Estimation of the up direction: on shapes with a known one, rotated to all six axes, and on real scans outside the
// repository.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/clock.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/ply_reader.hpp"
#include "tests/cloud/upright_shapes.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test::up_test {

using namespace upright;

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
    PointCloud room = turned(roomFromWithin(), up);
    const Upright found = findUp(room);
    CAPTURE(found.why);
    CHECK(nameOf(found.up) == name);
    CHECK(found.isInterior);
    setUp(room.storedAs.comments, up);
    CHECK(findUp(room).isInterior);
    for (Vec3& normal : room.normals) normal = -normal;
    CHECK_FALSE(findUp(room).isInterior);
    for (const bool isEmptyRoom : {false, true}) {  // or a block of the same size
      PointCloud box;
      for (int i = 0; i < 10000; ++i)
        for (int side = 0; side < 6; ++side) {
          Vec3 p(0.02f * static_cast<float>(i % 100), 0.02f * static_cast<float>(i / 100), side % 2 ? 2.f : 0.f);
          Vec3 outwards(0, 0, side % 2 ? 1 : -1);
          for (int k = 0; k < side / 2; ++k)
            p = Vec3(p.y, p.z, p.x), outwards = Vec3(outwards.y, outwards.z, outwards.x);
          box.positions.push_back(p);
          box.normals.push_back(isEmptyRoom ? -outwards : outwards);
        }
      setUp(box.storedAs.comments, up);
      CHECK(findUp(box).isInterior == isEmptyRoom);
    }
    for (const bool isStreet : {false, true}) {  // a street between two walls, or a dam with the same sides
      PointCloud street;
      for (int i = 0; i < 20000; ++i) {
        const float along = 0.01f * static_cast<float>(i % 1000), across = 0.1f * static_cast<float>(i / 1000);
        street.positions.emplace_back(along, isStreet ? 0.f : 2.f, across);
        street.normals.emplace_back(0.f, 1.f, 0.f);
        for (const float side : {-1.f, 1.f}) {
          street.positions.emplace_back(along, across, 1 + side);
          street.normals.emplace_back(0.f, 0.f, isStreet ? -side : side);
        }
      }
      PointCloud upright = turned(street, up);
      setUp(upright.storedAs.comments, up);
      CHECK(findUp(upright).isInterior == isStreet);
    }
  }
}

TEST_CASE("a wavy sheet is seen from both sides, unlike a street") {
  for (const double height : {1.0, 3.0, 10.0, 20.0, 30.0})
    for (const double phase : {0.0, 1.5, 3.0})
      for (const auto& [name, up] : kUpAxes) {
        CAPTURE(height);
        CAPTURE(phase);
        CAPTURE(name);
        PointCloud sheet;
        for (int i = 0; i < 40000; ++i) {
          const double x = 0.5 * (i % 200) - 50, y = 0.5 * (i / 200) - 50, along = x / 20 + phase;
          sheet.positions.emplace_back(x, y, height * std::sin(along));
          sheet.normals.emplace_back(glm::normalize(DVec3(-height / 20 * std::cos(along), 0, 1)));
        }
        const Upright found = findUp(turned(sheet, up));
        CAPTURE(found.why);
        CHECK_FALSE(found.isInterior);
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
  const std::filesystem::path folder = sharedFile("rgbd_livingroom_a");
  if (folder.empty()) return;
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
  const std::filesystem::path file = sharedFile("formats/autzen_trim.laz");
  if (file.empty()) return;
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
  // Nor do single ones at any distance, to the last bit.
  for (const int count : {1, 5}) {
    CAPTURE(count);
    PointCloud cloud = statue();
    const Bounds box = boundsOf(cloud);
    for (int i = 0; i < count; ++i)
      add(cloud, 1e6 * box.longestSide() * DVec3(std::sin(2.0 * i), std::cos(2.0 * i), 0.3 * i), {0, 1, 0});
    const Bounds core = coreBoundsOf(cloud);
    CHECK(core.min == box.min);
    CHECK(core.max == box.max);
    CHECK(countOutside(cloud, core) == static_cast<std::size_t>(count));
  }
  // A group of many points is part of the model.
  PointCloud two = statue();
  const std::size_t count = two.size();
  for (std::size_t i = 0; i < count / 10; ++i) add(two, DVec3(two.positions[10 * i]) + DVec3(60, 0, 0), {0, 1, 0});
  CHECK(coreBoundsOf(two).max == boundsOf(two).max);
}

TEST_CASE("a sparse part of a model that adjoins the dense one is within the shown box") {
  PointCloud cloud;
  const auto square = [&](double x, int side) {
    for (int i = 0; i < side * side; ++i)
      add(cloud, DVec3(x + 50.0 * (i % side) / side, 50.0 * (i / side) / side, 0), {0, 0, 1});
  };
  square(0, 500);
  square(50, 50);
  CHECK(coreBoundsOf(cloud).max == boundsOf(cloud).max);
  const Bounds box = boundsOf(cloud);
  add(cloud, {1e6, 0, 0}, {0, 0, 1});
  CHECK(coreBoundsOf(cloud).max == box.max);
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
  const std::filesystem::path folder = sharedFile("");
  if (folder.empty()) return;
  for (const auto& [file, up] : kTruth) {
    CAPTURE(file);
    const PointCloud cloud = readPly(folder / file);
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
