// Splat scenes that are selected, cleaned, set and levelled: the steps are done to their Gaussians.
#include <doctest/doctest.h>

#include <fstream>

#include "engine/cloud/gaussian_records.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/select/chosen_points.hpp"
#include "engine/select/move_points.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "tests/content_of.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/splat_files.hpp"

namespace palpate::test::splats_prepared_test {

namespace {

struct Splats {
  explicit Splats(const SplatFile& itsFile) : file(itsFile) {
    std::ofstream(folder / "scene.ply", std::ios::binary) << file.bytes();
    cloud = readCloud(folder / "scene.ply").cloud;
  }
  SplatFile saved(const PointCloud& made) const {
    writeCloud(folder / "saved.ply", made);
    return parsedSplats(contentOf(folder / "saved.ply"));
  }
  SplatFile after(const Preparation& preparation) const { return saved(prepared(cloud, preparation, {}).cloud); }

  ScratchFolder folder;
  SplatFile file;
  PointCloud cloud;
};

}  // namespace

TEST_CASE("a box, a condition on a column of Gaussians, and outliers keep those Gaussians bit by bit") {
  const Splats splats(splatBall(2, 800, {.floaters = 0.02, .faint = 0.3}));
  const auto check = [&](const Preparation& preparation, auto&& holds) {
    const std::vector<std::size_t> rows = rowsIn(splats.after(preparation), splats.file);
    REQUIRE(rows.size() > 10);
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < splats.file.rows.size(); ++i)
      if (holds(i)) expected.push_back(i);
    CHECK(rows == expected);
  };
  check({.crop = std::array{DVec3(-3, -20, -20), DVec3(20, 4, 20)}}, [&](std::size_t i) {
    const DVec3 c = splats.file.center(i);
    return c.x >= -3 && c.x <= 20 && c.y >= -20 && c.y <= 4 && std::abs(c.z) <= 20;
  });
  check({.where = "opacity > 0"}, [&](std::size_t i) { return splats.file.at(i, "opacity") > 0; });
  check({.where = "f_rest_7 < 0.1 && z > 0"},
        [&](std::size_t i) { return splats.file.at(i, "f_rest_7") < 0.1 && splats.file.at(i, "z") > 0; });
  CHECK(errorOf<ConfigError>([&] { prepared(splats.cloud, {.fillHoles_mm = 3}, {}); }) ==
        "prepare.fill_holes_mm: the holes of a splat scene cannot be closed, because new points are not Gaussians");
  // The cut scene is felt as it would be after it was saved and read again.
  const PointCloud cut = prepared(splats.cloud, {.where = "x > 1"}, {}).cloud;
  writeCloud(splats.folder / "cut.ply", cut);
  CHECK(readCloud(splats.folder / "cut.ply").cloud.positions == cut.positions);
  CHECK(errorOf([&] { prepared(splats.cloud, {.where = "sharpness > 1"}, {}); }).find("sharpness") !=
        std::string::npos);
}

TEST_CASE("rules set columns of Gaussians, colours, new columns, and scale a scene whose unit changes") {
  const Splats splats(splatBall(1, 500));
  const SplatFile set = splats.after({.set = {"opacity = 3 if x > 0", "red = 255 if x > 0"}});
  const SplatDifference difference = differenceOf(splats.file, set);
  CHECK(difference.columns == std::set<std::string>{"opacity", "f"});
  for (const std::size_t i : difference.rows) {
    CHECK(splats.file.center(i).x > 0);
    CHECK(set.at(i, "f_dc_0") == within(0.5 / 0.28209479177387814, 1e-5));
    CHECK(set.at(i, "f_rest_0") == splats.file.at(i, "f_rest_0"));
  }
  const SplatFile labelled = splats.after({.set = {"float32 label = 7 if z > 0"}});
  REQUIRE(labelled.names.back() == "label");
  for (std::size_t i = 0; i < labelled.rows.size(); ++i) {
    CHECK(labelled.rows[i].substr(0, splats.file.rows[i].size()) == splats.file.rows[i]);
    CHECK((labelled.at(i, "label") == 7) == (splats.file.at(i, "z") > 0));
  }
  const SplatFile larger = splats.after({.set = {"x = 1000 * x", "y = 1000 * y + 5", "z = 1000 * z"}});
  const SplatFile longer = splats.after({.set = {"x = 1000 * x"}});
  for (std::size_t i = 0; i < larger.rows.size(); ++i)
    for (const char* name : {"scale_0", "scale_1", "scale_2"}) {
      CHECK(larger.at(i, name) == within(static_cast<double>(splats.file.at(i, name)) + std::log(1000.0), 1e-4));
      CHECK(longer.at(i, name) == splats.file.at(i, name));
    }
}

TEST_CASE("levelling rotates all Gaussians with the scene") {
  GaussianScene scene;
  SceneRandom random(3);
  for (int i = 0; i < 900; ++i)
    addGaussian(scene, DVec3(i % 30, i / 30, 0.2 * (i % 30)), {0.75, 0.6, 0.3}, rotationTo({0, 0, 1}, random), 0.9,
                {1, 0.5, 0});
  const Splats splats(splatFileOf(scene, 3));
  PointCloud level = splats.cloud;
  const DVec3 normal = glm::normalize(DVec3(-0.2, 0, 1));
  rotateToZ(level, normal);
  const SplatFile saved = splats.saved(level);
  REQUIRE(saved.rows.size() == splats.file.rows.size());
  const DVec3 axis = glm::normalize(glm::cross(normal, DVec3(0, 0, 1)));
  const double half = 0.5 * std::acos(normal.z);
  const DQuat rotation(std::cos(half), std::sin(half) * axis);
  for (std::size_t i = 0; i < saved.rows.size(); ++i) {
    CHECK(saved.center(i).z == within(saved.center(0).z, 1e-4));
    for (int k = 0; k < 3; ++k) {
      const DVec3 d = random.direction();
      const DVec3 was = colorAlong(splats.file, i, d), is = colorAlong(saved, i, rotation * d);
      CHECK(glm::distance(is, was) < 1e-5);
      const DVec3 turned = rotation * d;
      CHECK(glm::dot(turned, covarianceOf(saved, i) * turned) ==
            within(glm::dot(d, covarianceOf(splats.file, i) * d), 1e-5));
    }
  }
  const PreparedCloud found = prepared(splats.cloud, {.where = "x < 25", .level = true}, {.up = UpAxis::z});
  CHECK(found.steps.size() == 2);
  const SplatFile part = splats.saved(found.cloud);
  CHECK(part.rows.size() == 750);
  for (std::size_t i = 0; i < part.rows.size(); ++i) CHECK(part.center(i).z == within(part.center(0).z, 0.1));
}

TEST_CASE("some points of a splat scene have the Gaussians that belong to them") {
  const Splats splats(splatBall(1, 800));
  PointSet upper;
  for (std::size_t i = 0; i < splats.cloud.size(); ++i) upper.set(i, splats.cloud.positions[i].z > 0);
  const SplatFile saved = splats.saved(chosenPoints(splats.cloud, upper));
  const std::vector<std::size_t> rows = rowsIn(saved, splats.file);
  REQUIRE(rows.size() > 200);
  for (const std::size_t i : rows) CHECK(splats.file.center(i).z > -2);
}

}  // namespace palpate::test::splats_prepared_test
