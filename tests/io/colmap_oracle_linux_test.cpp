// Reading of COLMAP folders, compared with COLMAP if it is installed: COLMAP converts a model to its other form, and
// both are read as the same model.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <tuple>

#include "engine/io/cloud_formats.hpp"
#include "engine/io/colmap_model.hpp"
#include "tests/colmap_writer.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test::colmap_oracle_test {
namespace {

bool hasColmap() {
  if (std::system("command -v colmap > /dev/null") == 0) return true;
  MESSAGE("skipped: colmap is not installed (package colmap)");
  return false;
}

void convert(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& form) {
  std::filesystem::create_directories(to);
  const std::string command = fmt::format(
      "QT_QPA_PLATFORM=offscreen colmap model_converter --input_path '{}' --output_path '{}' --output_type {} "
      "> /dev/null 2>&1",
      from.string(), to.string(), form);
  REQUIRE_MESSAGE(std::system(command.c_str()) == 0, command);
}

std::vector<ColmapPoint> pointsOf(const std::filesystem::path& folder, const ColmapModel& model) {
  std::vector<ColmapPoint> points;
  readColmapPoints(folder, model, [&](const ColmapPoint& point) { points.push_back(point); });
  return points;
}

std::vector<std::size_t> byPlace(const PointCloud& cloud) {
  std::vector<std::size_t> order(cloud.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) {
    const DVec3 p = cloud.fileCoordinates(i);
    return std::tuple(p.x, p.y, p.z);
  });
  return order;
}

/// `tolerance`: resolution of the decimals that COLMAP writes.
void checkSame(const std::filesystem::path& one, const std::filesystem::path& other, double tolerance) {
  const ColmapModel a = readColmapImages(one), b = readColmapImages(other);
  REQUIRE(a.cameras.size() == b.cameras.size());
  REQUIRE(a.images.size() == b.images.size());
  // COLMAP may write images in another order; they are matched by name.
  const auto named = [](const ColmapModel& model, const std::string& name) {
    for (const ColmapImage& image : model.images)
      if (image.name == name) return image;
    FAIL(name);
    return ColmapImage{};
  };
  for (const ColmapImage& image : a.images) {
    const ColmapImage again = named(b, image.name);
    CHECK(image.id == again.id);
    CHECK(a.cameras[image.camera].id == b.cameras[again.camera].id);
    CHECK(a.cameras[image.camera].model == b.cameras[again.camera].model);
    CHECK(a.cameras[image.camera].parameters == b.cameras[again.camera].parameters);
    CHECK(glm::distance(image.center, again.center) <= tolerance * (1 + glm::length(image.center)));
    CHECK(glm::distance(image.forward, again.forward) <= tolerance);
    CHECK(glm::distance(image.down, again.down) <= tolerance);
  }
  CHECK(frustaOf(a).size() == frustaOf(b).size());
  // Points may be in any order, too; they are matched by position.
  const auto sorted = [](std::vector<ColmapPoint> points) {
    std::ranges::sort(points, {},
                      [](const ColmapPoint& p) { return std::tuple(p.position.x, p.position.y, p.position.z); });
    return points;
  };
  const auto points = sorted(pointsOf(one, a)), again = sorted(pointsOf(other, b));
  REQUIRE(points.size() == again.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK(glm::distance(points[i].position, again[i].position) <= tolerance * (1 + glm::length(points[i].position)));
    CHECK(points[i].color == again[i].color);
    CHECK(points[i].error == within(again[i].error, 1e-5 * (1 + std::abs(again[i].error))));
    REQUIRE(points[i].images.size() == again[i].images.size());
    for (std::size_t k = 0; k < points[i].images.size(); ++k)
      CHECK(a.images[points[i].images[k]].id == b.images[again[i].images[k]].id);
  }
}

}  // namespace

TEST_CASE("COLMAP's other form of a written model is read as the same model") {
  if (!hasColmap()) return;
  const ScratchFolder folder;
  WrittenColmap written{.images = {{.id = 3, .centre = {1, 2, 3}, .turn = glm::normalize(DQuat(0.9, 0.1, -0.3, 0.2))},
                                   {.id = 70, .centre = {-4, 0.5, 2}}},
                        .points = {}};
  writeColmap(folder / "text", written);
  convert(folder / "text", folder / "binary", "BIN");
  CHECK(std::filesystem::exists(folder / "binary" / "images.bin"));
  checkSame(folder / "text", folder / "binary", 1e-12);
}

TEST_CASE("COLMAP's other forms of a real reconstruction are read as the same one, normals included") {
  if (!hasColmap()) return;
  const std::filesystem::path real = sharedFile("colmap_a");
  if (real.empty()) return;
  const ScratchFolder folder;
  convert(real, folder / "text", "TXT");
  REQUIRE(std::filesystem::exists(folder / "text" / "points3D.txt"));
  convert(folder / "text", folder / "binary", "BIN");
  checkSame(real, folder / "text", 1e-9);
  checkSame(real, folder / "binary", 1e-9);
  const PointCloud cloud = readCloud(real).cloud;
  for (const char* form : {"text", "binary"}) {
    const PointCloud again = readCloud(folder / form).cloud;
    REQUIRE(again.size() == cloud.size());
    const std::vector<std::size_t> order = byPlace(cloud), orderAgain = byPlace(again);
    for (std::size_t i = 0; i < order.size(); ++i)
      CHECK(glm::distance(cloud.normals[order[i]], again.normals[orderAgain[i]]) < 1e-4f);
  }
}

}  // namespace palpate::test::colmap_oracle_test
