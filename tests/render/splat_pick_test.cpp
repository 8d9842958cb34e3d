// Selection of the drawn discs and their paths: the level of detail, large discs, crowds, and both widths of atomics.
#include <algorithm>
#include <cmath>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "shaders/shared/render.h"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::splat_pick_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 72;

struct Difference {
  std::size_t covered = 0;     // pixels covered in the first
  std::size_t silhouette = 0;  // pixels covered in only one
  double depthRms = 0;         // over the pixels covered in both
  double largestColor = 0;     // largest difference of a channel, 0 to 255
};

class SplatPickFixture : public PictureFixture {
 public:
  using PictureFixture::PictureFixture;

 protected:
  struct Shot {
    Image image;
    DepthImage depths;
  };
  Shot shoot(Frame& frame, const DrawnCloud& cloud, const Camera& camera, const FrameOptions& options) {
    draw(frame, cloud, camera, options);
    return {frame.readColor(), frame.readDepth()};
  }
  static Difference compare(const Shot& a, const Shot& b) {
    Difference difference;
    double squares = 0;
    std::size_t both = 0;
    for (std::size_t i = 0; i < a.depths.depth.size(); ++i) {
      const float da = a.depths.depth[i], db = b.depths.depth[i];
      difference.covered += da > 0;
      difference.silhouette += (da > 0) != (db > 0);
      for (int k = 0; k < 3; ++k)
        difference.largestColor = std::max(difference.largestColor, std::abs(double(a.image.rgba[i][std::size_t(k)]) -
                                                                             b.image.rgba[i][std::size_t(k)]));
      if (!(da > 0 && db > 0)) continue;
      ++both;
      squares += double(da - db) * (da - db);
    }
    difference.depthRms = std::sqrt(squares / std::max<double>(1, double(both)));
    return difference;
  }
};

Camera cameraAt(double distance) {
  Camera camera;
  camera.eye = {0.3 * distance, 0.2 * distance, 0.93 * distance};
  return camera;
}

}  // namespace

TEST_CASE_FIXTURE(SplatPickFixture, "a subset of the points shows the same picture as all of them, without holes") {
  // Discs of 0.1 to 0.5 samples: from one point in twenty to five in six.
  const PointCloud cloud = sampleShape(*makeShape("sphere", 2.0), {.count = 50'000});
  const double spacing = meanSpacing(cloud);
  const DrawnCloud drawn(device, cloud, {.spacing = spacing});
  Frame& frame = frameOf(kWidth, kHeight, 1);
  for (const double distance : {3.0, 6.0, 12.0}) {
    CAPTURE(distance);
    const Camera camera = cameraAt(distance);
    const double pixel = distance / camera.focal_px(kHeight);
    FrameOptions options{.pass = ImagePass::normal};
    const Shot some = shoot(frame, drawn, camera, options);
    const double share = frame.readDiscs() / double(cloud.size());
    CHECK(share < std::min(1.0, 8.0 / (distance * distance)));
    CHECK(share > 2.0 / (distance * distance));
    options.everyPoint = true;
    const Shot all = shoot(frame, drawn, camera, options);
    CHECK(frame.readDiscs() == cloud.size());
    const Difference difference = compare(all, some);
    CHECK(difference.covered > 100);
    // Discs of a sample's radius extend beyond the outline by up to that radius.
    CHECK(double(difference.silhouette) <= 8 * std::sqrt(double(difference.covered)));
    CHECK(difference.depthRms < 0.6 * pixel);
    std::size_t wrong = 0, inside = 0;
    for (std::uint32_t y = 0; y < kHeight; ++y)
      for (std::uint32_t x = 0; x < kWidth; ++x) {
        const double offset = glm::distance(DVec2(x + 0.5, y + 0.5), DVec2(kWidth, kHeight) / 2.0) * pixel;
        if (offset > 0.8) continue;
        ++inside;
        const auto &a = all.image.at(x, y), &b = some.image.at(x, y);
        const DVec3 na = DVec3(a[0], a[1], a[2]) / 127.5 - 1.0, nb = DVec3(b[0], b[1], b[2]) / 127.5 - 1.0;
        wrong += some.depths.at(x, y) == 0 || angleBetween_deg(na, nb) > 60 * pixel + 2;
      }
    CHECK(inside > 30);
    CHECK(wrong == 0);
  }
}

TEST_CASE_FIXTURE(CoreValidated<SplatPickFixture>, "no disc pops while the camera moves away") {
  const PointCloud cloud = sampleShape(*makeShape("bumpy-sphere", 2.0), {.count = 100'000});
  const DrawnCloud drawn(device, cloud, {.spacing = meanSpacing(cloud)});
  Frame& frame = frameOf(kWidth, kHeight, 2);
  // Around the distance where the first points are skipped, and one where most are.
  for (const double from : {2.9, 8.0}) {
    Shot last = shoot(frame, drawn, cameraAt(from), {.pass = ImagePass::normal});
    FrameOptions every{.pass = ImagePass::normal, .everyPoint = true};
    Shot lastEvery = shoot(frame, drawn, cameraAt(from), every);
    for (int step = 1; step <= 6; ++step) {
      const Camera camera = cameraAt(from * (1 + 1e-4 * step));
      const Shot shot = shoot(frame, drawn, camera, {.pass = ImagePass::normal});
      const Shot shotEvery = shoot(frame, drawn, camera, every);
      double moved = 0, movedEvery = 0;
      for (std::size_t i = 0; i < shot.image.rgba.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
          moved += std::abs(int(shot.image.rgba[i][k]) - int(last.image.rgba[i][k]));
          movedEvery += std::abs(int(shotEvery.image.rgba[i][k]) - int(lastEvery.image.rgba[i][k]));
        }
      CAPTURE(from);
      CAPTURE(moved);
      CAPTURE(movedEvery);
      // Overall it changes as little as a picture of all points.
      CHECK(moved < 1.5 * movedEvery + 0.02 * double(shot.image.rgba.size()));
      last = shot;
      lastEvery = shotEvery;
    }
  }
}

TEST_CASE_FIXTURE(CoreValidated<SplatPickFixture>, "both widths of atomics give the same picture bit by bit") {
  PointCloud cloud = strewnCloud(3000);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.colors.push_back({std::uint8_t(i), std::uint8_t(i / 7), std::uint8_t(i / 31), 255});
  const DrawnCloud drawn(device, cloud);
  const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
  Frame wide(device, kWidth, kHeight, 2, true), narrow(device, kWidth, kHeight, 2, false);
  for (const double radius : {0.01, 0.08, 0.6}) {
    for (const ImagePass pass : {ImagePass::normal, ImagePass::color}) {
      const FrameOptions options{.pass = pass, .splatRadius = radius};
      const Shot a = shoot(wide, drawn, camera, options), b = shoot(narrow, drawn, camera, options);
      CHECK(a.image.rgba == b.image.rgba);
      CHECK(a.depths.depth == b.depths.depth);
    }
  }
  if (!device.hasWideAtomics()) MESSAGE("this device has no atomics of 64 bits: both were narrow");
}

TEST_CASE_FIXTURE(SplatPickFixture, "a disc that fills the picture is whole, however large") {
  PointCloud cloud;
  cloud.positions.emplace_back(0.1, 0, 0);
  cloud.normals.emplace_back(0, 0, 1);
  Camera camera;
  camera.eye = {0, 0, 3};
  camera.nearDepth = 0.1;
  for (const UVec2 size_px : {UVec2(2200, 3), UVec2(3, 2200), UVec2(1300, 20)}) {
    Frame frame(device, size_px.x, size_px.y, 1);
    const Shot shot = shoot(frame, DrawnCloud(device, cloud), camera, {.splatRadius = 3000, .closeHoles = false});
    CHECK(std::ranges::all_of(shot.depths.depth, [](float d) { return d > 0; }));
  }
}

TEST_CASE_FIXTURE(SplatPickFixture,
                  "a crowd of discs that fill the picture still covers it, and they are round" * kFull) {
  // More than 2,048 discs of 512 tiles each exceed the capacity for shares.
  constexpr std::uint32_t kSide = 256;
  PointCloud cloud;
  cloud.positions.assign(16'000, Vec3(0));
  cloud.normals.assign(cloud.size(), Vec3(0, 0, 1));
  Camera camera;
  camera.eye = {0, 0, 3};
  Frame frame(device, kSide, kSide, 1);
  const auto covered = [&](std::size_t count) {
    PointCloud some = cloud;
    some.positions.resize(count);
    some.normals.resize(count);
    const Shot shot = shoot(frame, DrawnCloud(device, some), camera, {.splatRadius = 5, .closeHoles = false});
    return static_cast<std::size_t>(std::ranges::count_if(shot.depths.depth, [](float d) { return d > 0; }));
  };
  CHECK(covered(2100) == kSide * kSide);
  const double shrunk = std::sqrt(double{shared::kMaxShares} / (512.0 * 16'000));
  CHECK(5 * camera.focal_px(kSide) / 3 > kSide);
  const double radius_px = shrunk * kSide;
  CHECK(covered(16'000) == near(3.14159265 * radius_px * radius_px, 0.02));
}

TEST_SUITE_END();

}  // namespace palpate::splat_pick_test
