// Files written by other programs, kept outside the repository.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "engine/io/ply_reader.hpp"
#include "tests/io/ply_bytes.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test::ply_wild_test {
namespace {

void checkNear(const DVec3& found, const nlohmann::json& expected) {
  for (int k = 0; k < 3; ++k) {
    const double value = expected[static_cast<std::size_t>(k)].get<double>();
    CHECK(std::abs(found[k] - value) <= 1.2e-7 * std::abs(value) + 1e-12);
  }
}

void checkCloud(const std::filesystem::path& path, const nlohmann::json& truth) {
  const PlyInfo info = readPlyInfo(path);
  CHECK(plyName(info.format) == truth["format"].get<std::string>());
  REQUIRE(info.elements.size() == truth["elements"].size());
  for (std::size_t k = 0; k < info.elements.size(); ++k) {
    CHECK(info.elements[k].name == truth["elements"][k][0].get<std::string>());
    CHECK(info.elements[k].count == truth["elements"][k][1].get<std::uint64_t>());
  }
  const PointCloud cloud = readPly(path);
  REQUIRE(cloud.size() == truth["vertices"].get<std::size_t>());
  const Bounds box = boundsOf(cloud);
  checkNear(cloud.origin + box.min, truth["bbox_min"]);
  checkNear(cloud.origin + box.max, truth["bbox_max"]);
  checkNear(cloud.fileCoordinates(0), truth["first"]);
  checkNear(cloud.fileCoordinates(cloud.size() - 1), truth["last"]);
  CHECK(cloud.hasNormals() == truth["normals"].get<bool>());
  CHECK(cloud.hasColors() == !truth["colours"].empty());
  CHECK(cloud.storedAs.alpha == (truth["colours"].size() == 4));
  if (!cloud.hasColors()) return;
  const double scale = isFloating(cloud.storedAs.color) ? 255.0 : 1.0;
  for (std::size_t k = 0; k < truth["colours"].size(); ++k)
    CHECK(cloud.colors[0][k] == std::lround(scale * truth["first_colour"][k].get<double>()));
}

}  // namespace

TEST_CASE("PLY files of other programs are read as their manifest says") {
  const std::filesystem::path list = sharedFile("wild/manifest.json");
  if (list.empty()) return;
  std::ifstream file(list);
  const nlohmann::json manifest = nlohmann::json::parse(file);
  for (const auto& [name, truth] : manifest.items()) {
    CAPTURE(name);
    const std::string expect = truth["expect"];
    const std::filesystem::path path = list.parent_path() / name;
    if (expect == "ok") {
      CHECK_NOTHROW(checkCloud(path, truth));
    } else {
      const std::string message = errorOf([&] { readPly(path); });
      const bool namesPlace = message.starts_with(path.string() + ":");
      CHECK((namesPlace || (expect == "either" && message.empty())));
    }
  }
}

}  // namespace palpate::test::ply_wild_test
