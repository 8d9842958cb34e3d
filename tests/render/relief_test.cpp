// Occlusion and cavities of surfaces whose depths and normals are known in closed form.
#include "engine/render/relief.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>

#include "engine/gpu/transfer.hpp"
#include "shaders/shared/look.h"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"

namespace palpate::relief_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr double kPi = 3.14159265358979;

/// Where a ray in eye space (x right, y up, depth 1) meets a surface.
struct Hit {
  double depth;
  DVec3 normal;
};
using Surface = std::function<std::optional<Hit>(const DVec3& ray)>;

Surface plane(const DVec3& through, const DVec3& normal) {
  const DVec3 unit = glm::normalize(normal);
  return [=](const DVec3& ray) -> std::optional<Hit> {
    const double depth = glm::dot(unit, through) / glm::dot(unit, ray);
    if (!(depth > 0)) return std::nullopt;
    return Hit{depth, unit};
  };
}
/// `inside`: its far side, as a bowl.
Surface ball(const DVec3& center, double radius, bool inside = false) {
  return [=](const DVec3& ray) -> std::optional<Hit> {
    const double a = glm::dot(ray, ray), b = glm::dot(ray, center), c = glm::dot(center, center) - radius * radius;
    if (b * b < a * c) return std::nullopt;
    const double depth = (b + (inside ? 1 : -1) * std::sqrt(b * b - a * c)) / a;
    return Hit{depth, (inside ? -1.0 : 1.0) * glm::normalize(depth * ray - center)};
  };
}
Surface nearestOf(const Surface& a, const Surface& b) {
  return [=](const DVec3& ray) {
    const std::optional<Hit> first = a(ray), second = b(ray);
    return !first || (second && second->depth < first->depth) ? second : first;
  };
}
std::optional<Hit> nothing(const DVec3&) { return std::nullopt; }

struct View {
  UVec2 size_px{0};  // of the picture
  std::uint32_t supersample = 1;
  double focal_px = 60;  // per pixel of the picture
  double usualRadius = 0, occlusionRadius = 0.5;

  UVec2 samples() const { return size_px * supersample; }
  DVec3 rayOfSample(double x, double y) const {
    const DVec2 offset = (DVec2(x, y) + 0.5 - 0.5 * DVec2(samples())) / (focal_px * supersample);
    return {offset.x, -offset.y, 1};
  }
  DVec3 rayOfPixel(std::uint32_t x, std::uint32_t y) const {
    const std::uint32_t middle = supersample / 2;
    return rayOfSample(x * supersample + middle, y * supersample + middle);
  }
};

struct Result {
  std::vector<float> access, cavity;
};

class ReliefFixture : public GpuFixture {
 protected:
  Result draw(const View& view, const Surface& surface) {
    const std::uint64_t samples = std::uint64_t{view.samples().x} * view.samples().y;
    const std::uint64_t pixels = std::uint64_t{view.size_px.x} * view.size_px.y;
    std::vector<std::uint32_t> depths, sums, sources;
    constexpr double kScale = 1 << 20;
    for (std::uint32_t i = 0; i < samples; ++i) {
      const std::optional<Hit> hit = surface(view.rayOfSample(i % view.samples().x, i / view.samples().x));
      depths.push_back(hit ? std::bit_cast<std::uint32_t>(static_cast<float>(hit->depth)) : shared::kNoDepth);
      // The camera looks along -z of the model.
      const DVec3 normal = hit ? DVec3(hit->normal.x, hit->normal.y, -hit->normal.z) : DVec3(0);
      for (int k = 0; k < 3; ++k) sums.push_back(static_cast<std::uint32_t>(std::lround(kScale * (normal[k] + 1))));
      sums.push_back(static_cast<std::uint32_t>(kScale));
      sources.push_back(i);
    }
    shared::RenderFrame constants{};
    constants.view = {.eye = Vec3(0),
                      .focal_px = static_cast<float>(view.focal_px * view.supersample),
                      .right = Vec3(1, 0, 0),
                      .nearDepth = 0,
                      .up = Vec3(0, 1, 0),
                      .supersample = view.supersample,
                      .forward = Vec3(0, 0, -1),
                      .isOrthographic = 0,
                      .center_px = 0.5f * Vec2(view.samples()),
                      .size_px = view.samples()};
    constants.usualRadius = static_cast<float>(view.usualRadius);
    constants.occlusionRadius = static_cast<float>(view.occlusionRadius);
    ConstantBlock frame(device, sizeof constants, 1, "constants");
    frame.write(0, constants);
    const auto uploaded = [&](const std::vector<std::uint32_t>& words, const char* name) {
      Buffer buffer = deviceWords(device, words.size(), name);
      upload(device, device.throughputQueue(), buffer, words);
      return buffer;
    };
    const Buffer depth = uploaded(depths, "depth"), normals = uploaded(sums, "normals"),
                 source = uploaded(sources, "sources");
    Relief relief(device, {view.size_px.x, view.size_px.y, view.supersample});
    CommandList list(device, device.throughputQueue(), "relief");
    list.begin();
    list.use(frame, 0);
    relief.record(list, normals.address(), source.address(), depth.address(), true, true);
    list.end();
    device.throughputQueue().run(list);
    return {download<float>(device, device.throughputQueue(), relief.access(), pixels),
            download<float>(device, device.throughputQueue(), relief.cavity(), pixels)};
  }
};

/// The same horizons with many slices and steps, and the sky between them summed up numerically: of one pixel.
double accessOf(const View& view, const Surface& surface, std::uint32_t x, std::uint32_t y) {
  const auto here = surface(view.rayOfPixel(x, y));
  if (!here) return 1;
  const DVec3 at = here->depth * view.rayOfPixel(x, y), toEye = -glm::normalize(at), normal = here->normal;
  const double reach_px = std::min(double{shared::kSkyRadius} * view.occlusionRadius * view.focal_px / here->depth,
                                   double{shared::kHorizonReach} * view.size_px.y);
  const double reach = reach_px * here->depth / view.focal_px;
  double visible = 0, open = 0;
  constexpr int kSlices = 48, kAngles = 400;
  for (int slice = 0; slice < kSlices; ++slice) {
    const double turn = kPi * (slice + 0.5) / kSlices;
    const DVec3 direction(std::cos(turn), -std::sin(turn), 0);
    const DVec3 aside = glm::normalize(direction - glm::dot(direction, toEye) * toEye);
    // Highest angle from the view direction at which surfaces hide the sky, on both sides.
    double horizons[2]{kPi, kPi};
    const double tilt = std::atan2(glm::dot(normal, aside), glm::dot(normal, toEye));
    for (int side = 0; side < 2; ++side) {
      const double sign = side == 0 ? 1 : -1;
      double highest = std::cos(sign * tilt + 0.5 * kPi);
      for (double r = 1; r <= reach_px; r += 0.5) {
        const double px = x + sign * r * std::cos(turn), py = y + sign * r * std::sin(turn);
        if (px < 0 || py < 0 || std::round(px) >= view.size_px.x || std::round(py) >= view.size_px.y) break;
        const DVec3 ray =
            view.rayOfPixel(static_cast<std::uint32_t>(std::round(px)), static_cast<std::uint32_t>(std::round(py)));
        const auto there = surface(ray);
        if (!there) continue;
        const DVec3 away = there->depth * ray - at;
        if (glm::dot(away, normal) <= 0) continue;
        const double squared = glm::dot(away, away), weight = std::max(1 - squared / (reach * reach), 0.0);
        const double plain = std::cos(sign * tilt + 0.5 * kPi);
        highest = std::max(highest, plain + weight * (glm::dot(away, toEye) / std::sqrt(squared) - plain));
      }
      horizons[side] = std::acos(std::clamp(highest, -1.0, 1.0));
    }
    for (int k = 0; k < kAngles; ++k) {
      const double angle = kPi * (2 * (k + 0.5) / kAngles - 1);
      const DVec3 sky = std::cos(angle) * toEye + std::sin(angle) * aside;
      const double light = std::max(glm::dot(sky, normal), 0.0) * std::abs(std::sin(angle));
      open += light;
      if (angle < horizons[0] && angle > -horizons[1]) visible += light;
    }
  }
  return visible / open;
}

}  // namespace

TEST_CASE_FIXTURE(ReliefFixture, "occlusion is the share of the sky above the horizons, at awkward sizes") {
  // A ball on a floor, before a wall.
  const Surface scene =
      nearestOf(ball({0.1, -0.25, 3}, 0.5), nearestOf(plane({0, -0.8, 3}, {0, 1, 0}), plane({0, 0, 4}, {0.2, 0, -1})));
  for (const UVec2 size_px : {UVec2(1, 1), UVec2(17, 3), UVec2(33, 41), UVec2(64, 48)})
    for (const std::uint32_t supersample : {1u, 2u}) {
      CAPTURE(size_px.x);
      CAPTURE(supersample);
      const View view{.size_px = size_px, .supersample = supersample};
      const Result result = draw(view, scene);
      double darkest = 1;
      std::vector<double> errors;
      for (std::uint32_t i = 0; i < result.access.size(); ++i) {
        const double expected = accessOf(view, scene, i % size_px.x, i / size_px.x);
        errors.push_back(std::abs(double{result.access[i]} - expected));
        darkest = std::min(darkest, expected);
      }
      std::ranges::sort(errors);
      CHECK(errors[errors.size() / 2] < 0.02);
      CHECK(errors[errors.size() * 95 / 100] < 0.1);  // at the rim of the ball the blur has few pixels
      if (size_px.y > 40) CHECK(darkest < 0.6);
    }
}

TEST_CASE_FIXTURE(ReliefFixture, "a plane is open and flat, however it is tilted, and so is an empty picture") {
  for (const DVec3& normal : {DVec3(0, 0, -1), DVec3(0.5, 0.8, -0.6), DVec3(-1, 0.3, -0.4)}) {
    const View view{.size_px = {37, 23}};
    const Result result = draw(view, plane({0, 0, 3}, normal));
    for (const float open : result.access) CHECK(open == within(1, 2e-3));
    for (const float cavity : result.cavity) CHECK(cavity == within(1, 2e-3));
  }
  for (const UVec2 size_px : {UVec2(1, 1), UVec2(17, 3)}) {
    const Result empty = draw({.size_px = size_px, .supersample = 2}, nothing);
    for (const float open : empty.access) CHECK(open == 1);
    for (const float cavity : empty.cavity) CHECK(cavity == 1);
  }
}

TEST_CASE_FIXTURE(ReliefFixture, "ridges and valleys show by the curvature of a ball and of a bowl") {
  for (const bool inside : {false, true})
    for (const double usualRadius : {0.0, 0.06}) {
      CAPTURE(inside);
      CAPTURE(usualRadius);
      const View view{.size_px = {61, 45}, .focal_px = 100, .usualRadius = usualRadius};
      const DVec3 center(0, 0, inside ? 1.5 : 4);
      constexpr double kRadius = 1.5;
      const Surface surface = ball(center, kRadius, inside);
      const Result result = draw(view, surface);
      std::size_t checked = 0;
      for (std::uint32_t i = 0; i < result.cavity.size(); ++i) {
        const std::uint32_t x = i % view.size_px.x, y = i / view.size_px.x;
        const auto hit = surface(view.rayOfPixel(x, y));
        if (!hit || -glm::dot(hit->normal, glm::normalize(view.rayOfPixel(x, y))) < 0.8) continue;
        const double pixel = hit->depth / view.focal_px;
        const double exact_px = shared::kCavityRadii * usualRadius / pixel;
        if (std::abs(exact_px - std::floor(exact_px) - 0.5) < 1e-3) continue;  // single precision may round otherwise
        const double narrow_px = std::clamp(std::round(exact_px), 1.0, double{shared::kCavityWidest_px});
        const auto wide_px = static_cast<std::uint32_t>(narrow_px) * shared::kCavityScale;
        if (x < wide_px || y < wide_px || x + wide_px >= view.size_px.x || y + wide_px >= view.size_px.y) continue;
        // Along every chord of a ball the normal changes by the chord's length over the radius.
        const double bend = (inside ? 1.0 : -1.0) * (1 + shared::kCavityScale) * narrow_px * pixel / kRadius;
        const double effect = bend / std::hypot(bend, double{shared::kCavityHalf});
        const double factor = 1 - (inside ? shared::kValleyShade : shared::kRidgeLight) * effect;
        CHECK(result.cavity[i] == within(factor, 0.02));
        ++checked;
      }
      CHECK(checked > 200);
    }
}

TEST_CASE_FIXTURE(ReliefFixture, "a step in depth is neither a valley nor a ridge") {
  const auto step = [](const DVec3& ray) -> std::optional<Hit> { return Hit{ray.x < 0 ? 3.0 : 5.0, DVec3(0, 0, -1)}; };
  for (const float cavity : draw({.size_px = {40, 20}}, step).cavity) CHECK(cavity == within(1, 1e-3));
}

TEST_CASE_FIXTURE(ReliefFixture, "the same surface gives the same bytes in every picture") {
  const Surface scene = nearestOf(ball({0, 0, 3}, 0.6), plane({0, -0.6, 3}, {0, 1, 0}));
  const View view{.size_px = {31, 27}, .supersample = 2, .usualRadius = 0.02};
  const Result first = draw(view, scene), second = draw(view, scene);
  CHECK(first.access == second.access);
  CHECK(first.cavity == second.cavity);
}

TEST_SUITE_END();

}  // namespace palpate::relief_test
