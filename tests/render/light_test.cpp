// What a picture's light adds to the plain look: materials, cavities, eye-dome light; and that nothing changes without.
#include <algorithm>
#include <cmath>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "shaders/shared/look.h"
#include "tests/near.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::light_test {

namespace {

double linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}
double encoded(double light) {
  light = std::clamp(light, 0.0, 1.0);
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

/// A head of 100 mm with a groove along its meridian, seen from the front: a ball whose radius is less there.
constexpr double kHead_mm = 50, kGrooveDepth_mm = 0.3, kGrooveWidth_mm = 1;  // radius; depth; standard deviation
PointCloud groovedHead() {
  PointCloud cloud;
  constexpr std::uint32_t kPoints = 400'000;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const double z = 1 - 2 * (i + 0.5) / kPoints, angle = 2.399963229728653 * i;
    if (z < 0.3) break;  // the front
    const DVec3 out(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    const double off_mm = kHead_mm * std::asin(out.x);
    const double dent_mm = kGrooveDepth_mm * std::exp(-0.5 * off_mm * off_mm / (kGrooveWidth_mm * kGrooveWidth_mm));
    const double slope = dent_mm * off_mm / (kGrooveWidth_mm * kGrooveWidth_mm);  // of the radius, by the way across
    const DVec3 across = glm::normalize(DVec3(1, 0, 0) - out.x * out);
    cloud.positions.emplace_back((kHead_mm - dent_mm) * out);
    cloud.normals.emplace_back(glm::normalize(out - slope * across));
  }
  return cloud;
}

/// Mean level of green along a line parallel to the groove, `off_mm` beside it.
double levelBeside(const Image& image, const Camera& camera, double off_mm) {
  double sum = 0;
  int count = 0;
  for (double along_mm = -12; along_mm <= 12; along_mm += 0.25) {
    const DVec3 position(off_mm, along_mm, std::sqrt(kHead_mm * kHead_mm - off_mm * off_mm - along_mm * along_mm));
    const auto place = camera.project(position, {image.width, image.height});
    REQUIRE(place);
    sum += image.at(static_cast<std::uint32_t>(place->x), static_cast<std::uint32_t>(place->y))[1];
    ++count;
  }
  return sum / count;
}

/// A plate in the middle of the picture with this normal.
PointCloud plate(const DVec3& normal, const std::array<std::uint8_t, 4>& color) {
  PointCloud cloud;
  const DVec3 right = glm::normalize(glm::cross(DVec3(0, 1, 0), normal)), up = glm::cross(normal, right);
  for (double x = -1; x <= 1; x += 0.1)
    for (double y = -1; y <= 1; y += 0.1) {
      cloud.positions.emplace_back(x * right + y * up);
      cloud.normals.emplace_back(normal);
      cloud.colors.push_back(color);
    }
  return cloud;
}

struct Lights {
  DVec3 key = glm::normalize(DVec3(-0.55, 0.66, -0.52)), keyLight{0.95, 0.89, 0.80};
  DVec3 fill = glm::normalize(DVec3(0.80, 0.05, -0.60)), fillLight{0.10, 0.125, 0.17};
  DVec3 sky{0.26, 0.29, 0.34}, ground{0.12, 0.10, 0.09};
};

/// Light of an open surface: normal `n` and direction to the eye `v` in eye space.
DVec3 lightOf(Material material, const DVec3& albedo, const DVec3& n, const DVec3& v) {
  const Lights lights;
  const double key = std::max(glm::dot(n, lights.key), 0.0);
  const DVec3 around = glm::mix(lights.ground, lights.sky, 0.5 + 0.5 * n.y);
  const DVec3 ambient = lights.fillLight * std::max(glm::dot(n, lights.fill), 0.0) + around;
  const double half = std::max(glm::dot(n, glm::normalize(lights.key + v)), 0.0);
  switch (material) {
    case Material::clay:
    case Material::water:  // of what stands in it
      return albedo * (lights.keyLight * key + ambient) +
             lights.keyLight * 0.16 * std::pow(half, 36) * std::min(4 * key, 1.0);
    case Material::stone: {
      // Oren and Nayar 1994 with the angles themselves.
      const double toLight = std::acos(glm::dot(n, lights.key)), toEye = std::acos(glm::dot(n, v));
      const DVec3 l = lights.key - glm::dot(n, lights.key) * n, e = v - glm::dot(n, v) * n;
      const double azimuths = glm::dot(l, e) / std::max(glm::length(l) * glm::length(e), 1e-12);
      const double squared = 0.6 * 0.6, a = 1 - 0.5 * squared / (squared + 0.33), b = 0.45 * squared / (squared + 0.09);
      // The model counts eyes and lights on the same side; what is left for others is negative.
      const double s = azimuths * std::sin(toLight) * std::sin(toEye);
      const double rim =
          azimuths > 0 ? azimuths * std::sin(std::max(toLight, toEye)) * std::tan(std::min(toLight, toEye)) : s;
      return albedo * (lights.keyLight * key * (a + b * rim) + ambient);
    }
    case Material::plaster:
      return albedo * (0.85 * lights.keyLight * std::max((glm::dot(n, lights.key) + 0.4) / 1.4, 0.0) + ambient);
    case Material::metal: {
      const DVec3 mirrored = 2 * glm::dot(n, v) * n - v;
      const double t = std::clamp((mirrored.y + 0.5) / 1.3, 0.0, 1.0);
      const DVec3 color = albedo + (1.0 - albedo) * std::pow(1 - std::clamp(glm::dot(n, v), 0.0, 1.0), 5);
      return color * (2.1 * glm::mix(lights.ground, lights.sky, t * t * (3 - 2 * t)) +
                      1.6 * lights.keyLight * std::pow(half, 60) + 0.25 * lights.keyLight * key);
    }
    case Material::unlit:
      return albedo;
  }
  return {};
}

Camera fromFront(double distance = 6) {
  Camera camera;
  camera.eye = {0, 0, distance};
  camera.nearDepth = 0.1;
  return camera;
}

}  // namespace

TEST_CASE_FIXTURE(PictureFixture, "a shallow groove is seen from any direction of the light, with cavity shading") {
  const PointCloud cloud = groovedHead();
  const DrawnCloud drawn(device, cloud, {.spacing = meanSpacing(cloud)});
  constexpr std::uint32_t kWidth = 900, kHeight = 600;
  Frame& frame = frameOf(kWidth, kHeight, 1);
  double least = 255, leastPlain = 255;
  for (int k = 0; k < 8; ++k) {
    Camera camera;  // the head fills the picture's height, and the light rolls with the camera
    camera.eye = {0, 0, 130};
    camera.fov_deg = 46;
    camera.nearDepth = 1;
    camera.up = {std::sin(k * 0.7853981633974483), std::cos(k * 0.7853981633974483), 0};
    const auto contrast = [&](bool cavity) {
      draw(frame, drawn, camera, {.light = {.cavity = cavity}});
      const Image image = frame.readColor();
      constexpr double kBeside_mm = 5;
      const double beside = 0.5 * (levelBeside(image, camera, -kBeside_mm) + levelBeside(image, camera, kBeside_mm));
      return beside - levelBeside(image, camera, 0);
    };
    const double with = contrast(true), without = contrast(false);
    MESSAGE("light at ", 45 * k, " degrees: contrast ", with, ", without cavity shading ", without);
    least = std::min(least, with);
    leastPlain = std::min(leastPlain, std::abs(without));
  }
  CHECK(least >= 4);
  CHECK(leastPlain < 4);
}

TEST_CASE_FIXTURE(PictureFixture, "each material sends the light to the eye as its formula says") {
  const std::array<std::uint8_t, 4> color{190, 120, 90, 255};
  const DVec3 albedo(linear(190 / 255.0), linear(120 / 255.0), linear(90 / 255.0));
  for (const Material material :
       {Material::clay, Material::stone, Material::plaster, Material::metal, Material::unlit, Material::water}) {
    CAPTURE(static_cast<int>(material));
    for (const DVec3& normal : {DVec3(0, 0, 1), DVec3(-0.5, 0.6, 0.7), DVec3(0.7, -0.2, 0.6), DVec3(0.1, -0.8, 0.6)}) {
      const DVec3 unit = glm::normalize(normal);
      const Image image =
          picture(plate(unit, color), fromFront(),
                  {.splatRadius = 0.2, .closeHoles = false, .light = {.material = material}}, 61, 61, 1);
      const DVec3 light = lightOf(material, albedo, {unit.x, unit.y, -unit.z}, {0, 0, -1});
      for (int k = 0; k < 3; ++k)
        CHECK(image.at(30, 30)[static_cast<std::size_t>(k)] == within(255 * encoded(light[k]), 1.6));
    }
  }
}

TEST_CASE_FIXTURE(PictureFixture, "occlusion, cavities and materials change only the picture itself") {
  const PointCloud cloud = sampleShape(*makeShape("torus", 3.0), {.count = 5000});
  FrameOptions options{.splatRadius = 0.1};
  Light all{.occlusion = true, .cavity = true, .ground = true, .eyeDome = true};
  for (const ImagePass pass : {ImagePass::depth, ImagePass::normal, ImagePass::color, ImagePass::position}) {
    options.pass = pass;
    options.light = {};
    const Image plain = picture(cloud, fromFront(), options, 80, 60);
    options.light = all;
    CHECK(picture(cloud, fromFront(), options, 80, 60).rgba == plain.rgba);
  }
  options.pass = ImagePass::final;
  all.material = Material::metal;
  options.light = {};
  const Image before = picture(cloud, fromFront(), options, 80, 60);
  options.light = all;
  const Image with = picture(cloud, fromFront(), options, 80, 60);
  CHECK(with.rgba != before.rgba);
  CHECK(picture(cloud, fromFront(), options, 80, 60).rgba == with.rgba);
  options.light = {};
  CHECK(picture(cloud, fromFront(), options, 80, 60).rgba == before.rgba);  // nothing is left of it
  for (const UVec2 size_px : {UVec2(1, 1), UVec2(17, 3), UVec2(33, 65)})
    for (const std::uint32_t supersample : {1u, 2u}) {
      options.light = all;
      const Image some = picture(cloud, fromFront(), options, size_px.x, size_px.y, supersample);
      CHECK(some.rgba.size() == std::size_t{size_px.x} * size_px.y);
      options.light = {};
      CHECK(picture({}, fromFront(), options, size_px.x, size_px.y, supersample).rgba == [&] {
        options.light = all;
        return picture({}, fromFront(), options, size_px.x, size_px.y, supersample).rgba;
      }());
    }
}

TEST_CASE_FIXTURE(PictureFixture, "eye-dome light darkens a sample by how much nearer those around it are") {
  const PointCloud cloud = strewnCloud(3000);
  constexpr std::uint32_t kWidth = 63, kHeight = 41;
  Frame& frame = frameOf(kWidth, kHeight, 1);
  const DrawnCloud drawn(device, cloud);
  // Unlit white points on white: what is left is the eye-dome light.
  FrameOptions options{.splatRadius = 0.06, .closeHoles = false, .light = {.material = Material::unlit}};
  draw(frame, drawn, fromFront(), options);
  const Image plain = frame.readColor();
  options.light.eyeDome = true;
  draw(frame, drawn, fromFront(), options);
  const Image with = frame.readColor();
  const DepthImage depths = frame.readDepth();
  const double focal_px = fromFront().focal_px(kHeight);
  double darkest = 1;
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const double here = double{depths.at(x, y)};
      double sum = 0;
      for (int ring = 1; here > 0 && ring <= static_cast<int>(shared::kEyeDomeRings); ++ring) {
        const int radius_px =
            static_cast<int>(std::lround(shared::kEyeDomeWidest_px * ring / double{shared::kEyeDomeRings}));
        const auto rise = [&](int dx, int dy) {
          const int nx = static_cast<int>(x) + radius_px * dx, ny = static_cast<int>(y) + radius_px * dy;
          if (nx < 0 || ny < 0 || nx >= static_cast<int>(kWidth) || ny >= static_cast<int>(kHeight)) return 0.0;
          const double there = double{depths.at(static_cast<std::uint32_t>(nx), static_cast<std::uint32_t>(ny))};
          const double steepest = double{shared::kEyeDomeSteepest};
          return there > 0 ? std::clamp(std::log2(here / there) * focal_px / radius_px, -steepest, steepest) : 0.0;
        };
        for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1), std::pair(1, 1), std::pair(1, -1)})
          sum += std::max(rise(dx, dy) + rise(-dx, -dy), 0.0);
      }
      const double factor = std::exp(-double{shared::kEyeDomeStrength} * sum / (4.0 * shared::kEyeDomeRings));
      darkest = std::min(darkest, factor);
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(with.at(x, y)[k] == within(255 * encoded(factor * linear(plain.at(x, y)[k] / 255.0)), 2));
    }
  CHECK(darkest < 0.5);
}

}  // namespace palpate::light_test
