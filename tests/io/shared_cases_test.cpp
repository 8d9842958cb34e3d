// Inputs that users of other programs reported as failing, kept outside the repository with the correct results.
#include <doctest/doctest.h>

#include <glm/common.hpp>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/e57_scans.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "tests/near.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test::shared_cases_test {
namespace {

using Rgb = std::array<int, 3>;

/// Expected result; by default that of the sheet.
struct Right {
  std::size_t points = 20;
  DVec3 low{0}, high{4, 3, 1.2}, first{0}, last{4, 3, 1.2};
  std::optional<Rgb> firstColor = {}, lastColor = {};
  bool normals = false;
  std::string lost = {};  ///< part of a message
};

bool isSaid(const StoredCloud& stored, const std::string& words) {
  return std::ranges::any_of(stored.lost, [&](const std::string& what) { return what.find(words) != what.npos; });
}

void checkColor(const std::array<std::uint8_t, 4>& found, const Rgb& expected) {
  for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(int{found[k]} - expected[k]) <= 1);
}

void checkCase(const std::filesystem::path& file, const Right& right) {
  CAPTURE(file.string());
  const StoredCloud stored = readCloud(file);
  const PointCloud& cloud = stored.cloud;
  REQUIRE(cloud.size() == right.points);
  const Bounds box = boundsOf(cloud);
  CHECK(glm::length(box.min + cloud.origin - right.low) < 1e-4);
  CHECK(glm::length(box.max + cloud.origin - right.high) < 1e-4);
  CHECK(glm::length(cloud.fileCoordinates(0) - right.first) < 1e-5);
  CHECK(glm::length(cloud.fileCoordinates(cloud.size() - 1) - right.last) < 1e-5);
  CHECK(cloud.hasColors() == right.firstColor.has_value());
  CHECK(cloud.hasNormals() == right.normals);
  if (right.firstColor && cloud.hasColors()) checkColor(cloud.colors.front(), *right.firstColor);
  if (right.lastColor && cloud.hasColors()) checkColor(cloud.colors.back(), *right.lastColor);
  CHECK((right.lost.empty() || isSaid(stored, right.lost)));
}

void checkMesh(const std::filesystem::path& file, std::size_t triangles, double area, const std::string& lost) {
  CAPTURE(file.string());
  const StoredCloud mesh = readCloud(file, nullptr, {.asTriangles = true});
  CHECK(mesh.triangles.size() == triangles);
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const DVec3 p = mesh.cloud.fileCoordinates(a);
    sum += 0.5 * glm::length(glm::cross(mesh.cloud.fileCoordinates(b) - p, mesh.cloud.fileCoordinates(c) - p));
  }
  if (area > 0) CHECK(sum == near(area, 1e-5));
  CHECK((lost.empty() || isSaid(mesh, lost)));
}

void checkBall(const std::filesystem::path& file, double off, const Rgb& color) {
  CAPTURE(file.string());
  const PointCloud cloud = readCloud(file).cloud;
  REQUIRE(cloud.size() > 100);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    CHECK(glm::length(cloud.fileCoordinates(i)) == within(1, off));
    checkColor(cloud.colors[i], color);
  }
}

void checkFrames(const std::filesystem::path& folder, std::size_t frames, std::size_t lost) {
  CAPTURE(folder.string());
  RgbdFolder played(folder, {}, nullptr);
  std::size_t read = 0, missed = 0;
  double before_s = -1;
  for (bool more = true; more;) {
    DepthFrame frame;
    try {
      more = played.next(frame);
      if (!more) break;
    } catch (const Error&) {
      ++missed;
      continue;
    }
    ++read;
    CHECK(frame.time_s > before_s);
    before_s = frame.time_s;
    CHECK(std::ranges::count(frame.depth_m, 2.f) == 153'600);
  }
  CHECK(read == frames);
  CHECK(missed == lost);
}

constexpr Rgb kFirst{0, 0, 255}, kLast{200, 240, 55};

}  // namespace

TEST_CASE("files that users of other programs could not read are read, or refused with an error") {
  const std::filesystem::path cases = sharedFile("cases");
  if (cases.empty()) return;
  const Right plain, colored{.firstColor = kFirst, .lastColor = kLast};
  checkCase(cases / "ply/list_before_xyz_binary.ply", {.lost = "descriptor"});
  checkCase(cases / "ply/colour_ushort.ply", colored);
  checkCase(cases / "ply/colour_float255.ply", colored);
  checkCase(cases / "ply/normal_names_and_typo.ply", {.normals = true});
  checkCase(
      cases / "ply/nan_inf_rows.ply",
      {.points = 2, .low = {1, 2, 3}, .high = {4, 5, 6}, .first = {1, 2, 3}, .last = {4, 5, 6}, .lost = "3 points"});
  CHECK_THROWS_WITH_AS(readCloud(cases / "ply/count_too_large.ply"), doctest::Contains("ends after 20 of 21"),
                       FileError);
  checkCase(cases / "pcd/organised_nan.pcd", {.points = 14, .firstColor = kFirst, .lost = "6 points"});
  checkCase(cases / "pcd/rgb_float_is_nan.pcd", colored);
  checkCase(cases / "las/rgb_8bit_in_16.las", colored);
  checkCase(cases / "las/rgb_16bit_one_dark.las", colored);
  checkCase(cases / "text/decimal_comma.xyz", plain);
  checkCase(cases / "text/bom.csv", plain);
  checkCase(cases / "text/utf16.txt", plain);
  checkCase(cases / "text/xyzrgb_float01.xyz", colored);
  const DVec3 far(500000, 5500000, 0), there(500004, 5500003, 1.2);
  checkCase(cases / "text/easting_northing.csv", {.low = far, .high = there, .first = far, .last = there});
  checkCase(cases / "text/two_scans.ptx", {.points = 6,
                                           .low = {1, 1, 1},
                                           .high = {102, 2, 1},
                                           .first = {1, 1, 1},
                                           .last = {102, 2, 1},
                                           .lost = "2 points without an echo"});
  checkCase(cases / "npy/arr_0.npz", plain);
  checkCase(cases / "obj/points_colours_255.obj", colored);
  checkCase(cases / "off/points_only.off", plain);
  checkCase(cases / "gltf/points_with_colours.glb", {.low = {10, 0, 0},
                                                     .high = {14, 3, 1.2},
                                                     .first = {10, 0, 0},
                                                     .last = {14, 3, 1.2},
                                                     .firstColor = kFirst,
                                                     .lastColor = kLast});
  constexpr double kArea = 12.5053;
  checkMesh(cases / "obj/some_objects_coloured.obj", 2, 0, "3 corners have no colour");
  checkMesh(cases / "stl/binary_solid_trailing_bytes.stl", 24, kArea, "37 bytes");
  checkMesh(cases / "stl/binary_nan_vertex.stl", 22, 0, "2 triangles");
  checkMesh(cases / "off/header_glued.off", 24, kArea, "");
  checkBall(cases / "splat/degree0_no_normals.ply", 0.06, {164, 128, 92});
  checkBall(cases / "splat/inf_scale_nan_place_zero_rotation.ply", 0.06, {164, 128, 92});
  checkBall(cases / "splat/supersplat_compressed.ply", 0.02, {200, 100, 50});
}

TEST_CASE("E57 scans, COLMAP models of newer cameras and unordered depth frames of reported cases are read") {
  const std::filesystem::path cases = sharedFile("cases");
  if (cases.empty()) return;
  for (const char* model : {"rigs_frames_txt", "model_11_rad_tan_thin_prism_fisheye_txt", "model_15_fisheye_bin"})
    checkCase(cases / "colmap" / model, {.low = {0, 0, 5},
                                         .high = {4, 3, 6.2},
                                         .first = {0, 0, 5},
                                         .last = {4, 3, 6.2},
                                         .firstColor = kFirst,
                                         .normals = true});
  checkFrames(cases / "rgbd/tum_out_of_order", 3, 0);
  checkFrames(cases / "rgbd/tum_crlf_missing", 2, 1);
  if (!canReadE57()) return;
  checkCase(cases / "e57/colour_16bit_limits.e57", {.firstColor = kFirst, .lastColor = kLast});
  checkCase(cases / "e57/two_poses.e57", {.points = 40,
                                          .high = {100, 204, 301.2},
                                          .first = {100, 200, 300},
                                          .firstColor = kFirst,
                                          .lastColor = kLast,
                                          .lost = "pose"});
}

}  // namespace palpate::test::shared_cases_test
