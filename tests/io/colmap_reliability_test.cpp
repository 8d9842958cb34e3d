// Which points of a reconstruction are kept, on a scene with known truth: points of a sphere, triangulated from rays
// with noise. Some are seen by cameras too close together, some by images of something else, and some by only two
// wrongly matched images.
#include "engine/io/colmap_reliability.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <random>

#include "engine/io/cloud_formats.hpp"
#include "tests/colmap_writer.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test::colmap_reliability_test {
namespace {

constexpr double kRadius = 10, kRing = 40;  // radii of the sphere, and of the ring of cameras around it
constexpr double kFocal_px = 1000;
constexpr int kCameras = 72;
constexpr double kBeside = 0.1;  // distance between neighbouring cameras: a fifth of a degree seen from the sphere

enum class Kind { good = 1, narrow = 2, mistaken = 3, mispaired = 4 };

/// Three cameras at each position of the ring, which look at the centre.
std::vector<WrittenImage> ring() {
  std::vector<WrittenImage> images;
  for (int k = 0; k < kCameras; ++k)
    for (const double aside : {0.0, kBeside, 2 * kBeside}) {
      const double angle = 2 * std::numbers::pi * k / kCameras + aside / kRing;
      const DVec3 out(std::cos(angle), 0, std::sin(angle)), down(0, -1, 0);
      const DVec3 right = glm::cross(down, -out);
      const glm::dmat3 axes(right, down, -out);  // columns: the camera's axes in the world
      images.push_back({.id = 10 + 3 * static_cast<std::uint32_t>(images.size()),
                        .centre = kRing * out,
                        .turn = glm::conjugate(glm::quat_cast(axes))});
    }
  return images;
}

DVec2 projected(const WrittenImage& image, const DVec3& place) {
  const DVec3 p = image.turn * (place - image.centre);
  return kFocal_px / p.z * DVec2(p);
}

/// The position nearest to all rays through image positions, by least squares.
DVec3 triangulated(const std::vector<const WrittenImage*>& images, const std::vector<DVec2>& places_px) {
  glm::dmat3 sum(0);
  DVec3 right(0);
  for (std::size_t k = 0; k < images.size(); ++k) {
    const DVec3 ray = glm::normalize(glm::conjugate(images[k]->turn) * DVec3(places_px[k] / kFocal_px, 1));
    const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(ray, ray);
    sum += across;
    right += across * images[k]->centre;
  }
  return glm::inverse(sum) * right;
}

struct Reconstruction {
  WrittenColmap written;
  std::vector<Kind> kinds;
  std::vector<double> off;  ///< distance from the sphere
};

Reconstruction reconstructed() {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> noise_px(0, 0.5);
  Reconstruction made{
      .written = {.camera = "1 SIMPLE_PINHOLE 2000 2000 1000 1000 1000", .images = ring(), .points = {}},
      .kinds = {},
      .off = {}};
  for (int i = 0; i < 1200; ++i) {
    const Kind kind = i % 6 == 0    ? Kind::narrow
                      : i % 25 == 1 ? Kind::mistaken
                      : i % 25 == 2 ? Kind::mispaired
                                    : Kind::good;
    const double angle = 2 * std::numbers::pi * share(random), height = 0.6 * (share(random) - 0.5);
    const double level = std::sqrt(1 - height * height);
    const DVec3 truth = kRadius * DVec3(level * std::cos(angle), height, level * std::sin(angle));
    const int nearest = static_cast<int>(std::lround(angle / (2 * std::numbers::pi) * kCameras)) % kCameras;
    std::vector<const WrittenImage*> seen;
    std::vector<DVec2> places_px;
    WrittenPoint point{.color = {static_cast<int>(kind), 0, 0}, .images = {}};
    for (int k = 0; k < (kind == Kind::mispaired ? 2 : 3); ++k) {
      const int image = kind == Kind::narrow ? 3 * nearest + k : 3 * ((nearest + k + kCameras - 1) % kCameras);
      seen.push_back(&made.written.images[static_cast<std::size_t>(image)]);
      DVec2 place_px = projected(*seen.back(), truth);
      place_px.x += noise_px(random) + (kind == Kind::mispaired ? 40.0 * k : 0.0);
      place_px.y += noise_px(random) + (kind == Kind::mistaken ? 30.0 * (k - 1) : 0.0);
      places_px.push_back(place_px);
      point.images.push_back(seen.back()->id);
    }
    point.place = triangulated(seen, places_px);
    point.error_px = 0;
    for (std::size_t k = 0; k < seen.size(); ++k)
      point.error_px +=
          glm::distance(projected(*seen[k], point.place), places_px[k]) / static_cast<double>(seen.size());
    made.kinds.push_back(kind);
    made.off.push_back(std::abs(glm::length(point.place) - kRadius));
    made.written.points.push_back(point);
  }
  return made;
}

}  // namespace

TEST_CASE("points that their rays do not determine are left out, and all good ones are kept") {
  const Reconstruction made = reconstructed();
  std::array<std::size_t, 5> all{}, far{};
  for (std::size_t i = 0; i < made.kinds.size(); ++i) {
    ++all.at(static_cast<std::size_t>(made.kinds[i]));
    far.at(static_cast<std::size_t>(made.kinds[i])) += made.off[i] > 0.05 * kRadius;
  }
  const auto of = [](const auto& counts, Kind kind) { return counts[static_cast<std::size_t>(kind)]; };
  // Preconditions: good points lie on the sphere, and most of the narrow and mispaired ones far from it.
  REQUIRE(of(far, Kind::good) == 0);
  REQUIRE(2 * of(far, Kind::narrow) > of(all, Kind::narrow));
  REQUIRE(2 * of(far, Kind::mispaired) > of(all, Kind::mispaired));

  const ScratchFolder folder;
  writeColmap(folder.path(), made.written);
  const StoredCloud stored = readCloud(folder.path());
  std::array<std::size_t, 5> kept{};
  double farthest = 0;
  for (std::size_t i = 0; i < stored.cloud.size(); ++i) {
    ++kept.at(stored.cloud.colors[i][0]);
    farthest = std::max(farthest, std::abs(glm::length(stored.cloud.fileCoordinates(i)) - kRadius));
  }
  CHECK(of(kept, Kind::good) == of(all, Kind::good));
  CHECK(of(kept, Kind::narrow) == 0);
  CHECK(of(kept, Kind::mistaken) == 0);
  CHECK(of(kept, Kind::mispaired) == 0);
  CHECK(farthest < 0.05 * kRadius);
  CHECK(stored.leftOut ==
        fmt::format("{} of 1200 points, which are unreliable: {} with rays that meet at less than 1.5 degrees, {} with "
                    "errors of more than 4 pixels, {} that fewer than 3 images saw",
                    1200 - of(all, Kind::good), of(all, Kind::narrow), of(all, Kind::mistaken),
                    of(all, Kind::mispaired)));
  const StoredCloud every = readCloud(folder.path(), nullptr, {.keepUnreliable = true});
  CHECK(every.cloud.size() == 1200);
  CHECK(every.leftOut.empty());
}

TEST_CASE("three images and 1.5 degrees between any two of their rays make a point reliable") {
  ColmapModel model;
  const auto at = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return ColmapImage{.center = {std::sin(angle), 0, -std::cos(angle)}};
  };
  model.images = {at(0), at(0.7), at(1.49), at(1.51), at(180), at(90), {.center = DVec3(0)}};
  const auto judge = [&](std::vector<std::uint32_t> images, double error_px = 1) {
    return reliabilityOf({.position = DVec3(0), .error = error_px, .images = std::move(images)}, model);
  };
  CHECK(judge({0, 1, 2}) == Reliability::smallAngle);
  CHECK(judge({1, 2, 3}) == Reliability::smallAngle);
  CHECK(judge({1, 3, 2, 0}) == Reliability::reliable);
  CHECK(judge({0, 4, 0}) == Reliability::smallAngle);  // all look along one line
  CHECK(judge({0, 0, 5}) == Reliability::reliable);
  CHECK(judge({0, 0, 0}) == Reliability::smallAngle);
  CHECK(judge({6, 6, 6}) == Reliability::smallAngle);  // at the point itself
  CHECK(judge({}) == Reliability::reliable);           // unknown images
  CHECK(judge({0, 5}) == Reliability::fewViews);
  CHECK(judge({0, 5, 1}, 4) == Reliability::reliable);
  CHECK(judge({0, 5, 1}, 4.01) == Reliability::largeError);
  CHECK(judge({0, 5, 1}, -1) == Reliability::reliable);  // unknown error
  std::vector<std::uint32_t> crowd(100'000, 0);
  CHECK(judge(crowd) == Reliability::smallAngle);
  std::fill_n(crowd.begin(), crowd.size() / 2, 5u);
  CHECK(judge(crowd) == Reliability::reliable);
}

TEST_CASE("a reconstruction with mostly unreliable points keeps all of them") {
  for (const int reliable : {0, 14, 15}) {
    CAPTURE(reliable);
    const ScratchFolder folder;
    WrittenColmap written{.images = {{.id = 1}, {.id = 2, .centre = {1, 0, 0}}, {.id = 3, .centre = {0, 1, 0}}},
                          .points = {}};
    for (int i = 0; i < 30; ++i) {
      WrittenPoint& point = written.points.emplace_back();
      point = {.place = DVec3(0.1 * i, 0.01 * i * i, 5), .images = {1, 2}};
      if (i < reliable) point.images.push_back(3);
    }
    writeColmap(folder.path(), written);
    const StoredCloud stored = readCloud(folder.path());
    CHECK(stored.cloud.size() == (reliable < 15 ? 30 : 15));
    CHECK(stored.leftOut.empty() == (reliable < 15));
  }
}

}  // namespace palpate::test::colmap_reliability_test
