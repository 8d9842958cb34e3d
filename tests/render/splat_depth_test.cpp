// The depth image compared with a reference in double precision.
#include <algorithm>
#include <limits>

#include "tests/labels.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::splat_depth_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();

/// Range of a pixel: the nearest fragment that rounding cannot remove, and the nearest one that it can add.
struct Pixel {
  double sure = kNothing, possible = kNothing;
};

class Reference {
 public:
  Reference(const Camera& camera, double radius, std::uint32_t width, std::uint32_t height)
      : camera_(camera), axes_(camera.axes()), radius_(radius), size_(width, height), pixels_(width * height) {}

  void add(const DVec3& position, const DVec3& normal) {
    const DVec3 c = toEye(position - camera_.eye);
    if (c.z < camera_.nearDepth) return;
    const DVec3 n = glm::length(normal) < 0.5 ? -glm::normalize(c) : toEye(normal);
    const DVec2 center = DVec2(size_) / 2.0 + focal() / c.z * DVec2(c.x, -c.y);
    // Tests every pixel, without a bounding box that could be wrong.
    for (std::uint32_t y = 0; y < size_.y; ++y)
      for (std::uint32_t x = 0; x < size_.x; ++x) addFragment(c, n, center, x, y);
  }

  /// Pixels of `image` outside their range.
  std::size_t wrongPixels(const DepthImage& image) const {
    constexpr double kTolerance = 1e-3;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const double depth = image.depth[i] == 0 ? kNothing : image.depth[i];
      const bool fits = depth == kNothing ? pixels_[i].sure == kNothing
                                          : depth >= pixels_[i].possible * (1 - kTolerance) &&
                                                depth <= pixels_[i].sure * (1 + kTolerance);
      wrong += !fits;
    }
    return wrong;
  }
  std::size_t coveredPixels() const {
    return static_cast<std::size_t>(std::ranges::count_if(pixels_, [](const Pixel& p) { return p.sure < kNothing; }));
  }

 private:
  DVec3 toEye(const DVec3& v) const {
    return {glm::dot(axes_.right, v), glm::dot(axes_.up, v), glm::dot(axes_.forward, v)};
  }
  double focal() const { return camera_.focal_px(size_.y); }

  void addFragment(const DVec3& c, const DVec3& n, const DVec2& center, std::uint32_t x, std::uint32_t y) {
    constexpr double kPixelTolerance = 1e-2, kDepthTolerance = 1e-6;
    Pixel& pixel = pixels_[y * size_.x + x];
    const DVec2 at(x + 0.5, y + 0.5);
    const DVec2 away = glm::abs(center - at);
    const double off = std::max(away.x, away.y);
    if (off < 0.5 + kPixelTolerance) pixel.possible = std::min(pixel.possible, c.z);
    if (off < 0.5 - kPixelTolerance) pixel.sure = std::min(pixel.sure, c.z + radius_);

    const DVec3 ray((at.x - size_.x / 2.0) / focal(), -(at.y - size_.y / 2.0) / focal(), 1);
    const double slope = glm::dot(n, ray);
    const double depth = glm::dot(n, c) / slope;
    if (!std::isfinite(depth)) return;
    const double depthError = kDepthTolerance * glm::length(c) / std::abs(slope);
    const double q = glm::distance(depth * ray, c) / radius_;
    const double error = 1e-3 + depthError * glm::length(ray) / radius_;
    const double nearError = depthError + 1e-6 * camera_.nearDepth;
    if (q < 1 + error && depth > camera_.nearDepth - nearError)
      pixel.possible = std::min(pixel.possible, depth - depthError);
    if (q < 1 - error && depth > camera_.nearDepth + nearError) pixel.sure = std::min(pixel.sure, depth + depthError);
  }

  Camera camera_;
  Camera::Axes axes_;
  double radius_;
  UVec2 size_;
  std::vector<Pixel> pixels_;
};

class SplatDepthFixture : public PictureFixture {
 protected:
  /// For both rasterisers. Returns the number of pixels that the cloud covers.
  std::size_t checkDepth(const PointCloud& cloud, const Camera& camera, double radius, std::uint32_t width,
                         std::uint32_t height) {
    CAPTURE(width);
    CAPTURE(height);
    Frame& frame = frameOf(width, height, 1);
    FrameOptions options;
    options.splatRadius = radius;
    options.closeHoles = false;
    options.everyPoint = true;
    Reference reference(camera, radius, width, height);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      reference.add(cloud.positions[i], cloud.hasNormals() ? cloud.normals[i] : Vec3(0));
    const DrawnCloud drawn(device, cloud);
    for (const Raster raster : {Raster::compute, Raster::hardware}) {
      CAPTURE(static_cast<int>(raster));
      if (raster == Raster::hardware && !device.draws()) {
        MESSAGE("hardware is skipped: ", device.name(), " does not draw, or not under validation");
        continue;
      }
      options.raster = raster;
      draw(frame, drawn, camera, options);
      CHECK(reference.wrongPixels(frame.readDepth()) == 0);
    }
    return reference.coveredPixels();
  }
};

}  // namespace

TEST_CASE_FIXTURE(SplatDepthFixture, "the depth of scattered discs equals the reference at any picture size") {
  const auto check = [&](std::uint32_t width, std::uint32_t height, double radius, std::size_t count = 600) {
    const PointCloud cloud = strewnCloud(count);
    const Camera camera = Camera::fitting(cloud, double(width) / height);
    CHECK(checkDepth(cloud, camera, radius, width, height) > 0);
  };
  check(1, 1, 0.5);
  check(33, 17, 0.2);
  check(160, 120, 0.06);
  check(160, 120, 0.001);     // less than a pixel
  check(320, 240, 0.3, 100);  // many tiles
}

TEST_CASE_FIXTURE(SplatDepthFixture, "splatting handles no points, one point, and a thousand equal ones") {
  PointCloud cloud;
  Camera camera = Camera::fitting(cloud, 4.0 / 3);
  CHECK(checkDepth(cloud, camera, 0.1, 160, 120) == 0);
  cloud.positions = {Vec3(-3, -2, -1)};
  camera = Camera::fitting(cloud, 4.0 / 3);
  CHECK(checkDepth(cloud, camera, 0.1, 160, 120) > 0);
  camera.eye += DVec3(0.001, 0.001, 0);  // off the corner of four pixels
  camera.target += DVec3(0.001, 0.001, 0);
  CHECK(checkDepth(cloud, camera, 0, 160, 120) == 1);
  cloud.positions.assign(1000, Vec3(-3, -2, -1));
  CHECK(checkDepth(cloud, camera, 0.1, 160, 120) > 0);
}

TEST_CASE_FIXTURE(SplatDepthFixture, "splatting handles points beside, behind and on the near plane") {
  const PointCloud cloud = strewnCloud(300);
  Camera camera;
  camera.eye = {0, 0, 0.2};  // among the points
  camera.target = {0.3, 0.1, -1};
  camera.nearDepth = 0.05;
  CHECK(checkDepth(cloud, camera, 0.1, 160, 120) > 0);

  PointCloud onPlane;
  onPlane.positions = {Vec3(0, 0, -0.25f), Vec3(0.01f, 0, -0.2499f), Vec3(-0.01f, 0, -0.2501f), Vec3(0, 0, 0),
                       Vec3(0, 0, 1)};
  onPlane.normals = {Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(0, 0, 1)};
  Camera front;
  front.eye = {0, 0, 0};
  front.target = {0, 0, -1};
  front.nearDepth = 0.24;
  CHECK(checkDepth(onPlane, front, 0.02, 160, 120) > 0);
  front.nearDepth = 0.26;
  CHECK(checkDepth(onPlane, front, 0.02, 160, 120) == 0);

  PointCloud across;
  across.positions = {Vec3(0, 0, -0.3f)};
  across.normals = {glm::normalize(Vec3(1, 0, 0.5f))};
  CHECK(checkDepth(across, front, 0.2, 160, 120) > 0);
}

TEST_CASE_FIXTURE(SplatDepthFixture, "a cloud far from zero looks as it does at zero") {
  const Vec3 far(1000, -2000, 512);
  const PointCloud cloud = strewnCloud(200, far);
  CHECK(checkDepth(cloud, Camera::fitting(cloud, 4.0 / 3), 0.1, 160, 120) > 0);
}

TEST_CASE_FIXTURE(SplatDepthFixture, "discs seen edge-on stay thin") {
  PointCloud cloud;
  for (int i = 0; i < 50; ++i) {
    const float angle = 0.02f * static_cast<float>(i - 25);
    cloud.positions.emplace_back(0.04f * static_cast<float>(i - 25), 0, 0);
    cloud.normals.emplace_back(std::cos(angle), 0, std::sin(angle));
  }
  Camera camera;
  camera.eye = {0, 0, 3};
  CHECK(checkDepth(cloud, camera, 0.15, 160, 120) > 0);
}

TEST_SUITE_END();

}  // namespace palpate::splat_depth_test
