// Intrinsics and poses in the forms that files use.
#include "engine/io/camera_text.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "engine/core/error.hpp"
#include "tests/error_of.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/rgbd_writer.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::camera_text_test {

namespace {

using test::checkSaid;

std::string refusal(const std::string& json) {
  return errorOf([&] { parseCamera(json); });
}

void refuses(const std::string& json, const std::string& expected) { checkSaid(refusal(json), expected); }

std::string poseRefusal(const std::array<double, 16>& rows) {
  return errorOf([&] { cameraPose(rows); });
}

}  // namespace

TEST_CASE("both forms of intrinsics give the same camera") {
  const DepthCamera camera{.width = 640, .height = 480, .fx = 525, .fy = 526, .cx = 319.5, .cy = 239.25};
  const CameraText flat = parseCamera(intrinsicsJson(camera, R"(, "depth_scale": 1000.0)"));
  const CameraText matrix = parseCamera(R"({"width": 640, "height": 480, "depth_scale": 1000, "fps": 15,
      "intrinsic_matrix": [525, 0, 0, 0, 526, 0, 319.5, 239.25, 1], "serial_number": "7"})");
  CHECK(flat.camera == camera);
  CHECK(matrix.camera == camera);
  CHECK(flat.depthScale == 1000.0);
  CHECK(matrix.depthScale == 1000.0);
  CHECK_FALSE(flat.rate_Hz.has_value());
  CHECK(matrix.rate_Hz == 15.0);
}

TEST_CASE("invalid camera intrinsics are refused with the name of the field") {
  refuses("", "is not valid JSON");
  refuses("{\"width\": 640", "is not valid JSON");
  refuses("[1]", "is not a JSON object");
  refuses("{}", "has no \"width\"");
  refuses(R"({"width": 1e9, "height": 1})", "\"width\" is 1000000000...");
  refuses(R"({"width": 2.5, "height": 1})", "\"width\" is 2.5...");
  refuses(R"({"width": "640", "height": 1})", "\"width\" cannot be \"640\"");
  refuses(R"({"width": 640, "height": 0})", "\"height\" is 0...");
  refuses(R"({"width": 640, "height": 480, "fx": 5})", "has no \"fy\"");
  refuses(R"({"width": 640, "height": 480, "fx": 0, "fy": 1, "cx": 0, "cy": 0})", "...focal lengths...");
  refuses(R"({"width": 640, "height": 480, "intrinsic_matrix": [1, 2]})", "...list of 9 numbers...");
  // Row-major order, as other programs write it.
  refuses(R"({"width": 640, "height": 480, "intrinsic_matrix": [525, 0, 319.5, 0, 525, 239.5, 0, 0, 1]})",
          "...column by column...");
  const DepthCamera camera = recordedCamera();
  refuses(intrinsicsJson(camera, R"(, "depth_scale": 0.001)"), "...the number of values per metre...");
  CHECK(refusal(intrinsicsJson(camera, R"(, "depth_scale": -1)")) != "read");
  refuses(intrinsicsJson(camera, R"(, "fps": 0)"), "\"fps\" is 0; it must be above 0");
  refuses(intrinsicsJson(camera, R"(, "pose": [1, 2])"), "...list of 16 numbers...");
  refuses(intrinsicsJson(camera, R"(, "format": 7)"), "\"format\" cannot be 7");
  refuses(std::string(100'000, '['), "is not valid JSON");
  const ScratchFolder folder;
  writeBytes(folder / "a.json", "{}");
  CHECK_THROWS_WITH_AS(readCamera(folder / "a.json"),
                       doctest::Contains("a.json: has no \"width\"; expected intrinsics as JSON"), FileError);
}

TEST_CASE("a matrix and a quaternion give the same pose, and positions survive the path to the camera and back") {
  const CameraPose pose{.turn = glm::normalize(DQuat(0.9, 0.1, -0.3, 0.2)), .centre = {1, -2, 3}};
  const CameraPose read = cameraPose(rowsOf(pose));
  const DVec3 place(0.3, -0.7, 2);
  CHECK(glm::distance(read.toWorld(place), pose.toWorld(place)) < 1e-12);
  CHECK(glm::distance(read.toCamera(read.toWorld(place)), place) < 1e-12);
  CHECK(glm::distance(cameraPose(pose.centre, 1.01 * pose.turn).toWorld(place), pose.toWorld(place)) < 1e-12);
}

TEST_CASE("a rounded matrix becomes the nearest rotation, and one that is far off is refused") {
  const CameraPose pose = recordedPose(3);
  std::array<double, 16> rounded = rowsOf(pose);
  for (const std::size_t k : {0, 1, 2, 4, 5, 6, 8, 9, 10}) rounded[k] = std::round(rounded[k] * 1000) / 1000;
  const CameraPose read = cameraPose(rounded);
  CHECK(std::abs(glm::length(read.turn * DVec3(1, 2, 3)) - glm::length(DVec3(1, 2, 3))) < 1e-12);
  CHECK(glm::distance(read.turn * DVec3(0, 0, 1), pose.turn * DVec3(0, 0, 1)) < 1e-3);

  std::array<double, 16> rows = rowsOf(pose);
  rows[3] = std::numeric_limits<double>::quiet_NaN();
  checkSaid(poseRefusal(rows), "...row 1, column 4...");
  rows = rowsOf(pose);
  for (const std::size_t k : {0, 4, 8}) rows[k] *= 1.1;
  checkSaid(poseRefusal(rows), "...not a rotation...");
  rows = rowsOf(pose);
  for (const std::size_t k : {0, 4, 8}) rows[k] = -rows[k];
  checkSaid(poseRefusal(rows), "...mirrors...");
  rows = rowsOf(pose);
  rows[15] = 0;
  checkSaid(poseRefusal(rows), "...0 0 0 1...");
  checkSaid(poseRefusal({}), "...0 0 0 1...");
  CHECK_THROWS_AS(cameraPose(DVec3(0), DQuat(0, 0, 0, 0)), Error);
  CHECK_THROWS_AS(cameraPose(DVec3(0), DQuat(2, 0, 0, 0)), Error);
  CHECK_THROWS_AS(cameraPose(DVec3(std::numeric_limits<double>::infinity()), DQuat(1, 0, 0, 0)), Error);
}

TEST_CASE("between two poses the shorter arc is interpolated") {
  const CameraPose from{.turn = {1, 0, 0, 0}, .centre = {0, 0, 0}};
  CameraPose to{.turn = {std::cos(0.2), 0, std::sin(0.2), 0}, .centre = {2, 0, 0}};
  for (const double sign : {1.0, -1.0}) {
    to.turn = sign * DQuat(std::cos(0.2), 0, std::sin(0.2), 0);
    const CameraPose middle = between(from, to, 0.25);
    CHECK(middle.centre == DVec3(0.5, 0, 0));
    CHECK(angleBetween_deg(middle.turn * DVec3(0, 0, 1), DVec3(std::sin(0.1), 0, std::cos(0.1))) < 1e-9);
  }
}

}  // namespace palpate::camera_text_test
