// What is automatic in the light of a picture.
#include "haptics/session/light_config.hpp"

#include <doctest/doctest.h>

#include "engine/cloud/estimated_normals.hpp"
#include "engine/cloud/gaussian_records.hpp"
#include "haptics/session/model.hpp"

namespace palpate::light_config_test {

namespace {

Model modelWith(bool colors, bool estimated) {
  Model model;
  model.cloud.positions.assign(3, Vec3(0));
  model.cloud.normals.assign(3, Vec3(0, 0, 1));
  if (colors) model.cloud.colors.assign(3, {1, 2, 3, 255});
  if (estimated) markNormalsAsEstimated(model.cloud, true);
  return model;
}
constexpr LightFor kHardware{.isSoftware = false, .barePoints = false},
    kSoftware{.isSoftware = true, .barePoints = false};

}  // namespace

TEST_CASE("a scan with normals is drawn plainly on a software driver, and shaped on a GPU") {
  for (const bool colors : {false, true}) {
    const Model model = modelWith(colors, false);
    CHECK(lightOf({}, model, kSoftware) == Light());
    CHECK(lightOf({}, model, kHardware) == Light{.occlusion = true, .cavity = true, .ground = true});
  }
  CHECK(lightOf({}, modelWith(false, true), kSoftware) == Light());  // without colours it needs light
}

TEST_CASE("colours whose normals are estimates are shown as they are, with eye-dome light") {
  const Model bare = modelWith(true, true);
  CHECK(lightOf({}, bare, kSoftware) == Light{.material = Material::unlit, .eyeDome = true});
  CHECK(lightOf({}, bare, kHardware) == Light{.material = Material::unlit, .ground = true, .eyeDome = true});
  CHECK(lightOf({.material = Material::clay}, bare, kSoftware) == Light());
}

TEST_CASE("bare points have eye-dome light in place of occlusion and cavities") {
  const Model model = modelWith(true, false);
  CHECK(lightOf({}, model, {.isSoftware = false, .barePoints = true}) == Light{.ground = true, .eyeDome = true});
  CHECK(lightOf({}, model, {.isSoftware = true, .barePoints = true}) == Light());
}

TEST_CASE("what is requested is drawn on any driver") {
  const LightConfig all{
      .material = Material::metal, .occlusion = true, .cavity = true, .ground = true, .eyeDome = true};
  const LightConfig none{
      .material = Material::clay, .occlusion = false, .cavity = false, .ground = false, .eyeDome = false};
  for (const LightFor& picture : {kHardware, kSoftware}) {
    CHECK(lightOf(all, modelWith(true, true), picture) ==
          Light{.material = Material::metal, .occlusion = true, .cavity = true, .ground = true, .eyeDome = true});
    CHECK(lightOf(none, modelWith(true, true), picture) == Light());
  }
}

TEST_CASE("a room whose file has no normals is recognised by estimated ones, and stands on its floor") {
  Log log(true);
  PointCloud room;  // 5 m x 4 m x 2.5 m, z up, with a chest in the middle
  const auto isChest = [](double x, double y) { return x > 1.7 && x < 3.3 && y > 1.3 && y < 2.7; };
  const auto addFace = [&](const Vec3& corner, const Vec3& along, const Vec3& across) {
    const float length = glm::length(along), width = glm::length(across);
    for (float u = 0; u < length; u += 0.05f)
      for (float v = 0; v < width; v += 0.05f) {
        const Vec3 p = corner + u / length * along + v / width * across;
        if (p.z > 0 || !isChest(double{p.x}, double{p.y})) room.positions.push_back(p);
      }
  };
  const auto addWalls = [&](const Vec3& low, const Vec3& size) {
    const Vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    addFace(low, x, z);
    addFace(low + y, x, z);
    addFace(low, y, z);
    addFace(low + x, y, z);
    addFace(low + z, x, y);
  };
  addFace({0, 0, 0}, {5, 0, 0}, {0, 4, 0});
  addWalls({0, 0, 0}, {5, 4, 2.5f});
  addWalls({1.7f, 1.3f, 0}, {1.6f, 1.4f, 0.6f});
  CHECK_FALSE(findUp(room).isInterior);
  const Model model = modelOf(room, {.file = "room"}, {.log = log});
  CHECK(model.upright.isInterior);
  CHECK(nameOf(model.upright.up) == "z");
}

TEST_CASE("a splat scene is drawn by its Gaussians unless its surface or bare points are chosen") {
  PointCloud cloud;
  CHECK_FALSE(drawsGaussians(std::nullopt, cloud));
  CHECK_NOTHROW(requireGaussians(std::nullopt, cloud, "--splats"));
  CHECK_THROWS_WITH_AS(requireGaussians(true, cloud, "--splats"), doctest::Contains("--splats: the model contains no"),
                       UsageError);
  cloud.storedAs.baggage = std::make_shared<const GaussianRecords>(
      std::vector<GaussianRecords::Column>{{"x", ScalarType::f32, 0}}, BareVector<std::byte>());
  CHECK(drawsGaussians(std::nullopt, cloud));
  CHECK(drawsGaussians(true, cloud, true));
  CHECK_FALSE(drawsGaussians(false, cloud));
  CHECK_FALSE(drawsGaussians(std::nullopt, cloud, true));
  CHECK_NOTHROW(requireGaussians(true, cloud, "--splats"));
}

}  // namespace palpate::light_config_test
