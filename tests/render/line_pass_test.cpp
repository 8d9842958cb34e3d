// Lines in space: drawn between their projected ends, visible through surfaces, and without effect elsewhere.
#include "engine/render/line_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/cloud/analytic_shape.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::line_pass_test {

namespace {

constexpr std::uint32_t kWidth = 160, kHeight = 120;
constexpr std::array<std::uint8_t, 3> kRed{255, 0, 0}, kGreen{0, 255, 0};

Camera fromFront() {
  Camera camera;
  camera.eye = {0, 0, 4};
  camera.nearDepth = 0.1;
  return camera;
}

/// Projection of a position by that camera's definition: a vertical field of view of 45 degrees.
DVec2 seenAt(const DVec3& place) {
  const double focal_px = 0.5 * kHeight / std::tan(22.5 / 57.29577951308232), depth = 4 - place.z;
  return {0.5 * kWidth + focal_px * place.x / depth, 0.5 * kHeight - focal_px * place.y / depth};
}

class LineFixture : public PictureFixture {
 protected:
  LineFixture() {
    options_.splatRadius = 0.06;
    options_.background = {0, 0, 0};
  }
  Image shown(const std::vector<SpaceLine>& lines, std::uint32_t supersample = 2) {
    FrameOptions options = options_;
    options.lines = std::make_shared<const std::vector<SpaceLine>>(lines);
    return picture(sphere_, fromFront(), options, kWidth, kHeight, supersample);
  }
  Image bare(std::uint32_t supersample = 2) {
    return picture(sphere_, fromFront(), options_, kWidth, kHeight, supersample);
  }
  static std::array<std::uint8_t, 4> at(const Image& image, const DVec2& place_px) {
    return image.at(static_cast<std::uint32_t>(place_px.x), static_cast<std::uint32_t>(place_px.y));
  }
  /// Excess redness relative to the picture without lines.
  static int redder(const Image& image, const Image& without, const DVec2& place_px) {
    const auto now = at(image, place_px), before = at(without, place_px);
    return (now[0] - now[1]) - (before[0] - before[1]);
  }

  PointCloud sphere_ = sampleShape(*makeShape("sphere", 2.0), {.count = 5000});
  FrameOptions options_;
};

}  // namespace

TEST_CASE_FIXTURE(LineFixture, "a line is drawn exactly between the projections of its ends") {
  const DVec3 from(-1.3, 0.9, 1.2), to(0.7, -0.5, 2.1);
  for (const std::uint32_t supersample : {1u, 2u}) {
    CAPTURE(supersample);
    const Image without = bare(supersample),
                with = shown({{.from = from, .to = to, .color = kRed, .width_px = 2}}, supersample);
    for (int k = 0; k <= 20; ++k) CHECK(redder(with, without, seenAt(from + k / 20.0 * (to - from))) > 100);
    const DVec2 a = seenAt(from), b = seenAt(to), along = glm::normalize(b - a), across(-along.y, along.x);
    std::size_t changed = 0, beside = 0;
    for (std::uint32_t y = 0; y < kHeight; ++y)
      for (std::uint32_t x = 0; x < kWidth; ++x) {
        if (with.at(x, y) == without.at(x, y)) continue;
        ++changed;
        const DVec2 off = DVec2(x + 0.5, y + 0.5) - a;
        const double outside = std::max(-glm::dot(off, along), glm::dot(off, along) - glm::distance(a, b));
        beside += std::abs(glm::dot(off, across)) > 1.6 || outside > 1.6;
      }
    CHECK(changed > 1.5 * glm::distance(a, b));
    CHECK(beside == 0);
  }
}

TEST_CASE_FIXTURE(LineFixture, "lines behind the surface shine through faintly") {
  const Image without = bare();
  const auto across = [&](double z) {
    return redder(shown({{.from = {-0.5, 0.1, z}, .to = {0.5, 0.1, z}, .color = kRed, .width_px = 3}}), without,
                  seenAt({0.2, 0.1, z}));
  };
  const int before = across(1.5), behind = across(0), farBehind = across(-3);
  CHECK(before > 150);
  CHECK(behind > 20);
  CHECK(behind < before / 2);
  CHECK(std::abs(farBehind - behind) < 30);
}

TEST_CASE_FIXTURE(LineFixture,
                  "lines that start behind the eye, or end far outside, are drawn as far as they are visible") {
  const Image without = bare();
  const Image behind = shown({{.from = {1.35, 0.2, 9}, .to = {1.35, 0.2, -1}, .color = kRed, .width_px = 2}});
  for (const double z : {1.0, 0.5, 0.0, -0.9}) CHECK(redder(behind, without, seenAt({1.35, 0.2, z})) > 100);
  const Image wide = shown({{.from = {-1e9, 1.2, 0}, .to = {1e9, 1.2, 0}, .color = kRed, .width_px = 2}});
  for (const double x : {-1.9, -1.0, 0.3, 1.9}) CHECK(redder(wide, without, seenAt({x, 1.2, 0})) > 100);
  const Image all =
      shown({{.from = {0, 0, 5}, .to = {0, 3, 8}, .color = kRed}, {.from = {900, 0, 0}, .to = {900, 5, 0}}});
  CHECK(all.rgba == without.rgba);
}

TEST_CASE_FIXTURE(LineFixture, "no lines, and invalid lines, change no pixel") {
  const Image without = bare();
  CHECK(shown({}).rgba == without.rgba);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();
  CHECK(shown({{.from = {kNaN, 0, 0}, .to = {1, 1, 1}, .color = kRed},
               {.from = {0, 0, 0}, .to = {0, kInfinite, 0}, .color = kRed},
               {.from = {1e30, 0, 0}, .to = {0, 1, 2}, .color = kRed},
               {.from = {-1, 0, 2}, .to = {1, 0, 2}, .color = kRed, .opacity = 0},
               {.from = {-1, 0, 2}, .to = {1, 0, 2}, .color = kRed, .width_px = 0}})
            .rgba == without.rgba);
  const Image point = shown({{.from = {0, 1.2, 0}, .to = {0, 1.2, 0}, .color = kRed, .width_px = 4}});
  CHECK(redder(point, without, seenAt({0, 1.2, 0})) > 100);
}

TEST_CASE_FIXTURE(LineFixture, "crossing lines give the same picture in any order, and many lines are drawn") {
  std::vector<SpaceLine> lines;
  for (int k = 0; k < 700; ++k) {
    const double angle = 0.1 * k;
    lines.push_back({.from = {1.5 * std::cos(angle), 1.5 * std::sin(angle), 0.002 * k},
                     .to = {-1.5 * std::sin(angle), 1.5 * std::cos(2 * angle), 1.8},
                     .color = k % 2 == 0 ? kRed : kGreen,
                     .opacity = 0.3 + 0.001 * k});
  }
  const Image one = shown(lines);
  CHECK(one.rgba != bare().rgba);
  std::ranges::reverse(lines);
  CHECK(shown(lines).rgba == one.rgba);
}

}  // namespace palpate::line_pass_test
