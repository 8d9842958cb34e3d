// COLMAP's folders: both forms give the same cloud, whose normals face the cameras, invalid content is refused with its
// line or byte, and a corner of a camera's frustum is projected to the corner of its picture.
#include "engine/io/known_formats.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "engine/cloud/up.hpp"
#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/colmap_model.hpp"
#include "engine/io/saving.hpp"
#include "tests/colmap_writer.hpp"
#include "tests/io/colmap_bytes.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test::colmap_format_test {

using namespace colmap;

namespace {

StoredCloud reading(const Files& files, const std::string& form) {
  const ScratchFolder folder;
  write(folder.path(), files, form);
  return readCloud(folder.path());
}

void refuses(const Files& files, const std::string& form, const std::string& expected) {
  const ScratchFolder folder;
  write(folder.path(), files, form);
  const std::string said = errorOf<FileError>([&] { readCloud(folder.path()); });
  checkSaid(said.empty() ? "read" : said.substr(folder.path().string().size() + 1), expected);
}

const DQuat kTurn = glm::normalize(DQuat(0.8, 0.3, -0.4, 0.2));
const DVec3 kCentre{3, -7, 11};
const std::array<DVec2, 4> kCorners{{{0, 0}, {640, 0}, {640, 480}, {0, 480}}};

std::vector<CameraFrustum> frustaWith(const std::string& camera) {
  const ScratchFolder folder;
  writeColmap(folder.path(), {.camera = camera, .images = {{.centre = kCentre, .turn = kTurn}}, .points = {}});
  return frustaOf(readColmapImages(folder.path()));
}

/// In camera coordinates: x right, y down, z forward.
DVec3 seen(const DVec3& place) { return glm::mat3_cast(kTurn) * (place - kCentre); }

}  // namespace

TEST_CASE("both forms of a COLMAP folder give the same cloud, seen from the same side") {
  for (const auto& [files, form] : {std::pair{binary(), "bin"}, std::pair{text(), "txt"}}) {
    CAPTURE(form);
    const StoredCloud stored = reading(files, form);
    const PointCloud& cloud = stored.cloud;
    REQUIRE(cloud.size() == kSide * kSide);
    CHECK(cloud.fileCoordinates(kSide + 2) == DVec3(along(2), along(1), 5));
    CHECK(cloud.colors[300] == std::array<std::uint8_t, 4>{44, 10, 200, 255});
    for (const Vec3& normal : cloud.normals) CHECK(glm::distance(normal, Vec3(0, 0, -1)) < 1e-6f);
    REQUIRE(cloud.extra.size() == 2);
    CHECK(cloud.extra[0].name == "error");
    double error = 0;
    std::memcpy(&error, cloud.extra[0].data.data() + 300 * sizeof error, sizeof error);
    CHECK(error == reprojectionError(300));
    CHECK(cloud.extra[1].name == "track_length");
    std::uint32_t track = 0;
    std::memcpy(&track, cloud.extra[1].data.data(), sizeof track);
    CHECK(track == 2);
    CHECK(stored.lost == std::vector<std::string>{"2 images", "1 camera", "which images saw each point"});
    CHECK(findUp(cloud).up == UpAxis::minusY);
    CHECK(findUp(cloud).why == "the file says so");
  }
}

TEST_CASE("images of a COLMAP model have the positions and axes of their cameras") {
  const ScratchFolder folder;
  Files files = text();
  // A rotation of 90 degrees about x, which maps the world's y to the camera's z, and three units back.
  files.images = "3 0.7071067811865476 0.7071067811865476 0 0 0 0 3 7 turned\n\n900 1 0 0 0 -1 0 0 7 c.jpg\n\n";
  write(folder.path(), files, "txt");
  const ColmapModel model = readColmapImages(folder.path());
  REQUIRE(model.images.size() == 2);
  CHECK(model.cameras.at(0).parameters == std::vector<double>{500, 510, 320, 240});
  CHECK(glm::distance(model.images[0].center, DVec3(0, -3, 0)) < 1e-12);
  CHECK(glm::distance(model.images[0].forward, DVec3(0, 1, 0)) < 1e-12);
  CHECK(glm::distance(model.images[0].right, DVec3(1, 0, 0)) < 1e-12);
  CHECK(glm::distance(model.images[0].down, DVec3(0, 0, -1)) < 1e-12);
  CHECK(model.images[1].center == DVec3(1, 0, 0));
  CHECK(model.images[1].name == "c.jpg");
}

TEST_CASE("the contents of a COLMAP folder are read without its points, and a cloud is saved beside it") {
  const ScratchFolder folder;
  for (const std::string form : {"txt", "bin"}) {  // with both forms present the binary files are used
    write(folder.path(), form == "bin" ? binary() : text(), form);
    const FileContents contents = contentsOf(folder.path());
    REQUIRE(contents.elements.size() == 3);
    CHECK(contents.elements[0].count == kSide * kSide);
    CHECK(contents.elements[1].count == 2);
    CHECK(contents.elements[2].count == 1);
  }
  CHECK(nameBeside(folder.path()) == folder.path().string() + "-sculpted.ply");
  CHECK(nameBeside(folder.path() / "") == folder.path().string() + "-sculpted.ply");
  CHECK(cloudFormats().toRead(folder.path()).name == "COLMAP");
  const ScratchFolder empty;
  CHECK_THROWS_WITH_AS(readCloud(empty.path()), doctest::Contains("is not a folder of COLMAP"), FileError);
}

TEST_CASE("a cloud from COLMAP is written as PLY with all its attributes and its up direction") {
  const ScratchFolder folder;
  StoredCloud stored = reading(binary(), "bin");
  writeCloud(folder / "a.ply", stored.cloud);
  const PointCloud again = readCloud(folder / "a.ply").cloud;
  CHECK(again.positions == stored.cloud.positions);
  CHECK(again.normals == stored.cloud.normals);
  CHECK(again.colors == stored.cloud.colors);
  CHECK(again.extra.size() == 2);
  CHECK(findUp(again).up == UpAxis::minusY);
}

TEST_CASE("every binary COLMAP file that is truncated is refused with its byte") {
  const Files whole = binary();
  const auto check = [&](std::string Files::*file, const std::string& name, std::size_t step) {
    for (std::size_t size = 0; size < (whole.*file).size(); size += step) {
      CAPTURE(name);
      CAPTURE(size);
      Files cut = whole;
      (cut.*file).resize(size);
      refuses(cut, "bin", name + ".bin: byte ...");
    }
    Files longer = whole;
    longer.*file += 'x';
    refuses(longer, "bin", "...unexpected data after the last of...");
  };
  check(&Files::cameras, "cameras", 1);
  check(&Files::images, "images", 1);
  check(&Files::points, "points3D", 997);
}

TEST_CASE("wrong counts in COLMAP files allocate no memory, and are refused at the end of the file") {
  for (const std::uint64_t lie : {std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    Files files = binary();
    std::memcpy(files.points.data(), &lie, sizeof lie);
    refuses(files, "bin", "...the file ends where the id of a point should be...");
    files = binary();
    constexpr std::size_t kTrackAt = 8 + 8 + 24 + 3 + 8;
    std::memcpy(files.points.data() + kTrackAt, &lie, sizeof lie);
    refuses(files, "bin", "points3D.bin: byte ...");
    files = binary();
    const std::size_t seen = files.images.find("c.jpg") + 6;
    std::memcpy(files.images.data() + seen, &lie, sizeof lie);
    refuses(files, "bin", "...the file ends within the...");
  }
}

TEST_CASE("invalid lines of a COLMAP folder are refused with the line") {
  const auto with = [](std::string Files::*file, const std::string& content, const char* expected) {
    Files files = text();
    files.*file = content;
    refuses(files, "txt", expected);
  };
  with(&Files::cameras, "7 TELESCOPE 640 480 1 2 3\n", "read");  // points need no camera
  with(&Files::cameras, "7 PINHOLE 640 480 500 510 320\n",
       "cameras.txt:1: the line ends where a parameter of a camera should be");
  with(&Files::cameras, "7 PINHOLE 640 480 500 510 320 240 9\n", "cameras.txt:1: '9' follows the last number of a row");
  with(&Files::cameras, "#\n7 PINHOLE 640 480 500 510 320 nan\n",
       "cameras.txt:2: a parameter of a camera is nan, not a finite number");
  with(&Files::cameras, "7 PINHOLE 6 4 5 5 3 2\n7 PINHOLE 6 4 5 5 3 2\n", "cameras.txt:2: camera 7 is a duplicate");
  with(&Files::images, "3 0 0 0 0 0 0 0 7 a\n\n", "images.txt:1: the rotation of an image is zero");
  with(&Files::images, "3 1 0 0 0 0 0 0 8 a\n\n", "images.txt:1: image 3 is of camera 8, which does not exist");
  with(&Files::images, "3 1 0 0 0 0 0 0 7 a\n3 1 0 0 0 0 0 0 7 b", "images.txt:2: image 3 is a duplicate");
  with(&Files::images, "3 1 0 0 0 0 0 0 7 a\n10 20\n",
       "images.txt:2: the line ends where the rotation of an image should be");
  with(&Files::points, "1 0 0 0 1 2 300 0.5 3 0\n", "points3D.txt:1: found '300', expected a colour from 0 to 255");
  with(&Files::points, "1 0 0 inf 1 2 3 0.5 3 0\n",
       "points3D.txt:1: the position of a point is inf, not a finite number");
  with(&Files::points, "1 0 0 0 1 2 3 0.5 3 0 900\n",
       "points3D.txt:1: a track of 3 numbers; expected pairs of an image and a position in it");
  with(&Files::points, "1 0 0 0 1 2 3 0.5 4 0\n", "points3D.txt:1: point 1 was seen by image 4, which does not exist");
  with(&Files::points, "", "read");  // no points

  for (const std::int32_t model : {15, 16, 40}) {  // unknown models are skipped by the file's size
    Files unknown = binary();
    std::memcpy(unknown.cameras.data() + 12, &model, sizeof model);
    refuses(unknown, "bin", "read");
  }
  Files never = binary();
  const std::int32_t model = -1;
  std::memcpy(never.cameras.data() + 12, &model, sizeof model);
  refuses(never, "bin", "...camera model -1; expected a number of 0 or more...");

  const ScratchFolder folder;
  std::ofstream(folder / "points3D.txt") << text().points;
  CHECK_THROWS_WITH_AS(readCloud(folder.path()), doctest::Contains("has neither cameras.bin nor cameras.txt"),
                       FileError);
}

TEST_CASE("COLMAP images without a line of observations are all read, whatever their names") {
  for (const std::string& images : std::initializer_list<std::string>{
           "3 1 0 0 0 0 0 0 7 a.jpg\n900 1 0 0 0 -1 0 0 7 c.jpg\n12 1 0 0 0 0 1 0 7 d.jpg\n",
           "3 1 0 0 0 0 0 0 7 1\n900 1 0 0 0 -1 0 0 7 2\n\n12 1 0 0 0 0 1 0 7 3",
           "# some\n3 1 0 0 0 0 0 0 7 a 1 1\n5 6 -1 7 8 2\n900 1 0 0 0 -1 0 0 7 c d e\n12 1 0 0 0 0 1 0 7 "
           "f.jpg\n#\n"}) {
    const ScratchFolder folder;
    Files files = text();
    files.images = images;
    write(folder.path(), files, "txt");
    CAPTURE(images);
    const ColmapModel model = readColmapImages(folder.path());
    REQUIRE(model.images.size() == 3);
    CHECK(model.images[1].id == 900);
    CHECK(model.images[1].center == DVec3(1, 0, 0));
    CHECK(model.images[2].id == 12);
    CHECK(countColmap(folder.path()).images == 3);
  }
}

TEST_CASE("normals of COLMAP points without tracks face the nearest camera that looks at them, and all are kept") {
  // Two cameras look along z at a plane from both sides: that of z = 4 is nearer than that of z = 7, and one of z = 5.5
  // looks away.
  for (const bool binaryPoints : {false, true}) {
    const ScratchFolder folder;
    Files files = text();
    files.images = "1 1 0 0 0 0 0 -4 7 near\n\n2 0 0 1 0 0 0 7 7 behind\n\n3 1 0 0 0 0 0 -5.5 7 averted\n";
    files.points.clear();
    for (int i = 0; i < 25; ++i)
      files.points += fmt::format("{} {} {} 5 200.0 100.0 50 -1\n", i + 1, 0.02 * (i % 5), 0.02 * (i / 5));
    write(folder.path(), files, "txt");
    if (binaryPoints) {
      std::ofstream out(folder / "points3D.bin", std::ios::binary);
      const auto put = [&](auto value) { out.write(reinterpret_cast<const char*>(&value), sizeof value); };
      put(std::uint64_t{25});
      for (int i = 0; i < 25; ++i) {
        put(static_cast<std::uint64_t>(i + 1)), put(0.02 * (i % 5)), put(0.02 * (i / 5)), put(5.0);
        for (const int channel : {200, 100, 50}) put(static_cast<std::uint8_t>(channel));
        put(-1.0), put(std::uint64_t{0});
      }
    }
    const StoredCloud stored = readCloud(folder.path());
    REQUIRE(stored.cloud.size() == 25);
    CHECK(stored.leftOut.empty());
    CHECK(stored.cloud.colors[7] == std::array<std::uint8_t, 4>{200, 100, 50, 255});
    for (const Vec3& normal : stored.cloud.normals) CHECK(glm::distance(normal, Vec3(0, 0, -1)) < 1e-5f);
  }
}

TEST_CASE("of the models of a COLMAP project the one with the most points is read, and named") {
  for (const std::string within : {"sparse", ""}) {
    const ScratchFolder folder;
    const auto model = [&](int which, const Files& files, const char* form) {
      const std::filesystem::path made = folder.path() / within / std::to_string(which);
      std::filesystem::create_directories(made);
      write(made, files, form);
    };
    Files small = text();
    small.points = "1 0 0 5 1 2 3 0.5 3 0\n2 0 1 5 1 2 3 0.5 3 0\n";
    model(0, small, "txt");
    model(1, binary(), "bin");
    model(2, small, "txt");
    CHECK(cloudFormats().toRead(folder.path()).name == "COLMAP");
    CHECK(readCloud(folder.path()).cloud.size() == kSide * kSide);
    CHECK(contentsOf(folder.path()).madeFrom ==
          fmt::format("{} of 3 models, with {} points", (std::filesystem::path(within) / "1").string(), kSide * kSide));
    CHECK(readCloud(folder.path() / within / "2").cloud.size() == 2);
  }
}

TEST_CASE("a real reconstruction: the normal of every point faces the cameras that saw it") {
  const std::filesystem::path folder = sharedFile("colmap_a");
  if (folder.empty()) return;
  const ColmapModel model = readColmapImages(folder);
  CHECK(model.cameras.size() == 690);
  CHECK(model.images.size() == 177);
  const PointCloud cloud = readCloud(folder, nullptr, {.keepUnreliable = true}).cloud;
  REQUIRE(cloud.size() == 4217);
  std::size_t i = 0, views = 0, facing = 0;
  readColmapPoints(folder, model, [&](const ColmapPoint& point) {
    for (const std::uint32_t image : point.images) {
      ++views;
      facing += glm::dot(DVec3(cloud.normals[i]), model.images[image].center - point.position) > 0;
    }
    ++i;
  });
  CHECK(i == cloud.size());
  MESSAGE(facing, " of ", views, " views are on the side of the normal");
  CHECK(static_cast<double>(facing) > 0.95 * static_cast<double>(views));
  // The photographed objects are farther than 60 units. Most points floating in front of them are removed, and hardly
  // any of the others.
  const auto inTheAir = [](const PointCloud& of) {
    return std::ranges::count_if(of.positions,
                                 [&](const Vec3& p) { return of.origin.z + static_cast<double>(p.z) < 60; });
  };
  const StoredCloud reliable = readCloud(folder);
  CHECK(reliable.cloud.size() == 4093);
  MESSAGE(inTheAir(reliable.cloud), " of ", inTheAir(cloud), " floating points remain");
  CHECK(2 * inTheAir(reliable.cloud) < inTheAir(cloud));
}

TEST_CASE("the corners of a frustum project to the corners of the picture") {
  // Distortion is left out, so that models of the same focal lengths see the same.
  for (const auto& [camera, fx, fy, cx, cy] :
       {std::tuple{"4 PINHOLE 640 480 500 510 310 250", 500., 510., 310., 250.},
        {"4 SIMPLE_PINHOLE 640 480 500 310 250", 500., 500., 310., 250.},
        {"4 SIMPLE_RADIAL 640 480 500 310 250 -0.1", 500., 500., 310., 250.},
        {"4 RADIAL 640 480 700 310 250 -0.1 0.02", 700., 700., 310., 250.},
        {"4 OPENCV 640 480 500 510 310 250 0.1 0.1 0.01 0.01", 500., 510., 310., 250.}}) {
    CAPTURE(camera);
    const auto frusta = frustaWith(camera);
    REQUIRE(frusta.size() == 1);
    CHECK(glm::distance(frusta[0].centre, kCentre) < 1e-12);
    for (std::size_t k = 0; k < 4; ++k) {
      const DVec3 p = seen(frusta[0].centre + 2.5 * frusta[0].corners[k]);
      CHECK(p.z == near(2.5, 1e-6));
      CHECK(fx * p.x / p.z + cx == within(kCorners[k].x, 1e-6));
      CHECK(fy * p.y / p.z + cy == within(kCorners[k].y, 1e-6));
    }
  }
}

TEST_CASE("the frustum of a fisheye lens follows its angles, up to the widest angle of a pyramid") {
  const auto frusta = frustaWith("4 OPENCV_FISHEYE 640 480 500 500 320 240 0 0 0 0");
  REQUIRE(frusta.size() == 1);
  const DVec3 p = seen(frusta[0].centre + frusta[0].corners[0]);
  CHECK(std::atan2(std::hypot(p.x, p.y), p.z) == near(std::hypot(320, 240) / 500, 1e-6));
  CHECK(p.x / p.y == near(320.0 / 240, 1e-6));
  const auto wide = frustaWith("4 SIMPLE_RADIAL_FISHEYE 640 480 200 320 240 0");
  const DVec3 far = seen(wide.at(0).centre + wide.at(0).corners[2]);
  CHECK(std::atan2(std::hypot(far.x, far.y), far.z) * 180 / std::numbers::pi == near(74.5, 0.01));
}

TEST_CASE("a camera with an invalid focal length or size has no frustum") {
  CHECK(frustaWith("4 PINHOLE 640 480 0 510 310 250").empty());
  CHECK(frustaWith("4 PINHOLE 640 480 500 -510 310 250").empty());
  CHECK(frustaWith("4 PINHOLE 640 480 500 1e-300 310 250").empty());
  CHECK(frustaWith("4 PINHOLE 0 480 500 510 310 250").empty());
}

TEST_CASE("the corners of a depth camera's frustum are half a pixel outside the centres of its corner pixels") {
  const DepthCamera camera{.width = 640, .height = 480, .fx = 525, .fy = 530, .cx = 319, .cy = 241};
  const CameraPose pose{.turn = glm::conjugate(kTurn), .centre = kCentre};
  const CameraFrustum frustum = frustumOf(camera, pose);
  for (std::size_t k = 0; k < 4; ++k) {
    const DVec3 p = seen(frustum.centre + 0.3 * frustum.corners[k]);
    CHECK(p.z == near(0.3, 1e-6));
    CHECK(525 * p.x / p.z + 319 == within(kCorners[k].x - 0.5, 1e-6));
    CHECK(530 * p.y / p.z + 241 == within(kCorners[k].y - 0.5, 1e-6));
  }
}

}  // namespace palpate::test::colmap_format_test
