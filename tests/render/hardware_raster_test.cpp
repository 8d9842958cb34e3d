// The graphics pipeline compared with the compute passes: the same picture.
#include "engine/render/hardware_raster.hpp"

#include <algorithm>
#include <limits>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/thinning.hpp"
#include "tests/labels.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::hardware_raster_test {

namespace {

constexpr std::uint32_t kWidth = 160, kHeight = 120;

/// Fractions of all pixels of two pictures.
struct Difference {
  double silhouette = 0;  ///< covered in only one of them
  double depth = 0;       ///< different depths, beyond rounding
  double color = 0;       ///< colours that differ by more than two units of 255 in a channel
  double covered = 0;     ///< covered in the first
};

Difference difference(const Image& color, const DepthImage& depth, const Image& otherColor,
                      const DepthImage& otherDepth) {
  Difference result;
  const double pixel = 1.0 / static_cast<double>(depth.depth.size());
  for (std::size_t i = 0; i < depth.depth.size(); ++i) {
    const float a = depth.depth[i], b = otherDepth.depth[i];
    result.covered += a > 0 ? pixel : 0;
    result.silhouette += (a > 0) != (b > 0) ? pixel : 0;
    result.depth += a > 0 && b > 0 && std::abs(a - b) > 1e-5f * a ? pixel : 0;
    int off = 0;
    for (std::size_t k = 0; k < 3; ++k) off = std::max(off, std::abs(color.rgba[i][k] - otherColor.rgba[i][k]));
    result.color += off > 2 ? pixel : 0;
  }
  return result;
}

PointCloud shapeCloud(const char* name, std::size_t count = 20'000) {
  return sampleShape(*makeShape(name, 2.0), {.count = count});
}

/// Coloured by position.
PointCloud colored(PointCloud cloud) {
  cloud.colors.clear();
  const auto encoded = [](float x) { return static_cast<std::uint8_t>(std::clamp(127.5f + 100 * x, 0.0f, 255.0f)); };
  for (const Vec3& p : cloud.positions) cloud.colors.push_back({encoded(p.x), encoded(p.y), encoded(p.z), 255});
  return cloud;
}

class HardwareRasterFixture : public PictureFixture {
 public:
  using PictureFixture::PictureFixture;

 protected:
  bool drawsHere() const {
    if (!device.draws()) MESSAGE("skipped: ", device.name(), " does not draw, or not under validation");
    return device.draws();
  }

  static constexpr double kFew = 2e-3;  // rim pixels that round differently

  /// Returns the fraction of the pixels that the cloud covers.
  double checkSame(const DrawnCloud& cloud, const Camera& camera, FrameOptions options = {},
                   std::uint32_t width = kWidth, std::uint32_t height = kHeight, std::uint32_t supersample = 2) {
    Frame& frame = frameOf(width, height, supersample);
    options.everyPoint = true;
    options.raster = Raster::compute;
    draw(frame, cloud, camera, options);
    const Image color = frame.readColor();
    const DepthImage depth = frame.readDepth();
    options.raster = Raster::hardware;
    draw(frame, cloud, camera, options);
    const Difference found = difference(color, depth, frame.readColor(), frame.readDepth());
    CHECK(found.silhouette <= kFew);
    CHECK(found.depth <= kFew);
    CHECK(found.color <= kFew);
    return found.covered;
  }
};

}  // namespace

TEST_CASE_FIXTURE(
    CoreValidated<HardwareRasterFixture>,
    "the hardware rasterizer draws shapes like the compute one, even and uneven, with and without colours" *
        kMoreInFull) {
  if (!drawsHere()) return;
  struct Look {
    const char* shape;
    double thinning;
  };
  for (const auto& [name, thinning] : byTier<std::vector<Look>>(
           {{"sphere", 1}, {"torus", 10}, {"cube", 1}},
           {{"sphere", 1}, {"sphere", 10}, {"torus", 1}, {"torus", 10}, {"cube", 1}, {"cube", 10}})) {
    CAPTURE(name);
    CAPTURE(thinning);
    const PointCloud cloud = thinning > 1 ? thinnedAlong(shapeCloud(name), thinning) : shapeCloud(name);
    Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
    camera.eye += DVec3(1.5, 1, 0);
    const double spacing = meanSpacing(cloud);
    // With discs that end at edges.
    CHECK(checkSame(DrawnCloud(device, cloud, {.spacing = spacing}), camera, {.pass = ImagePass::normal}) > 0.1);
    CHECK(checkSame(DrawnCloud(device, colored(cloud), {.spacing = spacing}), camera) > 0.1);
  }
}

TEST_CASE_FIXTURE(HardwareRasterFixture,
                  "the hardware rasterizer agrees from inside, with given radii, smoothed, and at odd sizes") {
  if (!drawsHere()) return;
  const PointCloud cloud = colored(shapeCloud("sphere"));
  const DrawnCloud drawn(device, cloud, {.spacing = meanSpacing(cloud)});
  Camera inside;
  inside.eye = {0.2, 0.1, 0.3};
  CHECK(checkSame(drawn, inside) > 0.99);
  const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
  for (const double radius : {1e-4, 0.03, 0.15}) CHECK(checkSame(drawn, camera, {.splatRadius = radius}) > 0.05);
  CHECK(checkSame(drawn, camera, {.pass = ImagePass::normal, .smooth_px = 2}) > 0.3);
  CHECK(checkSame(drawn, camera, {.pass = ImagePass::normal}, 33, 17, 1) > 0.1);
  CHECK(checkSame(drawn, camera, {}, 1, 1, 1) > 0.9);
}

TEST_CASE_FIXTURE(HardwareRasterFixture,
                  "discs wider than the GPU's maximum point size are drawn fully, beside small ones") {
  if (!drawsHere()) return;
  PointCloud cloud = colored(shapeCloud("sphere", 200));
  // Close to the eye, oblique. Two of them blend: a sample that is drawn twice shows in the colour.
  for (const Vec3& p : {Vec3(0.1f, 0.05f, 2.6f), Vec3(0.17f, 0.02f, 2.5f), Vec3(0.9f, -0.4f, 2.4f)}) {
    cloud.positions.push_back(p);
    cloud.normals.push_back(glm::normalize(p.x < 0.5f ? Vec3(0.3f, 0.2f, 1) : Vec3(1, 0.2f, 0.4f)));
    cloud.colors.push_back({static_cast<std::uint8_t>(p.x < 0.15f ? 250 : 20), 100, 20, 255});
  }
  Camera camera;
  camera.eye = {0, 0, 3};
  const DrawnCloud drawn(device, cloud);
  constexpr std::uint32_t kLargeWidth = 640, kLargeHeight = 480;
  const double disc_px = 2 * 0.2 * camera.focal_px(kLargeHeight) / 0.4;
  REQUIRE(disc_px > 300);  // larger than lavapipe's maximum point size
  FrameOptions options{.pass = ImagePass::color, .splatRadius = 0.2, .closeHoles = false};
  CHECK(checkSame(drawn, camera, options, kLargeWidth, kLargeHeight, 1) > 0.4);
}

TEST_CASE_FIXTURE(HardwareRasterFixture,
                  "the hardware rasterizer draws no point, one point, and crowds of equal points") {
  if (!drawsHere()) return;
  Camera camera;
  camera.eye = {0.1, 0.2, 3};
  FrameOptions options{.splatRadius = 0.01};
  CHECK(checkSame(DrawnCloud(device, PointCloud{}), camera, options) == 0);
  PointCloud cloud;
  cloud.positions = {Vec3(0)};
  CHECK(checkSame(DrawnCloud(device, cloud), camera, options) > 0);
  cloud.positions.assign(20'000, Vec3(0));
  cloud.normals.assign(cloud.size(), glm::normalize(Vec3(1, 2, 3)));
  cloud.colors.assign(cloud.size(), {250, 130, 3, 255});
  std::fill_n(cloud.colors.begin(), cloud.size() / 2, std::array<std::uint8_t, 4>{3, 130, 250, 255});
  const DrawnCloud crowd(device, cloud);
  options.splatRadius = 0.15;
  for (const auto pass : {ImagePass::color, ImagePass::normal}) {
    options.pass = pass;
    CHECK(checkSame(crowd, camera, options) > 0);
  }
}

TEST_CASE_FIXTURE(HardwareRasterFixture,
                  "in hardware a sheet seen from its back keeps its colour up to the rims, beside a crowd") {
  if (!drawsHere()) return;
  const PointCloud cloud = backBesideCrowd();
  Camera camera;
  camera.eye = {0, 0, 3};
  const FrameOptions options{.pass = ImagePass::color, .splatRadius = 0.5};
  CHECK(checkSame(DrawnCloud(device, cloud), camera, options, kWidth, kHeight, 1) > 0.05);
}

TEST_CASE_FIXTURE(
    HardwareRasterFixture,
    "the hardware rasterizer handles points that are not finite, without normals, behind or at the near plane") {
  if (!drawsHere()) return;
  PointCloud cloud = strewnCloud(2000);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  cloud.positions[7] = Vec3(nan);
  cloud.positions[8] = Vec3(0, infinite, 0);
  cloud.positions[9] = Vec3(1e30f, 0, 0);
  Camera camera;
  camera.eye = {0, 0, 0.2};  // among the points
  camera.target = {0.3, 0.1, -1};
  camera.nearDepth = 0.05;
  FrameOptions options{.splatRadius = 0.05};
  const DrawnCloud drawn(device, cloud);
  CHECK(checkSame(drawn, camera, options) > 0.8);
  options.pass = ImagePass::normal;
  CHECK(checkSame(drawn, camera, options) > 0.8);
}

TEST_CASE_FIXTURE(HardwareRasterFixture, "sheets within the blending band are blended, and those behind are not") {
  if (!drawsHere()) return;
  PointCloud cloud;
  for (const float depth : {0.0f, 0.05f, 0.5f})
    for (int y = -40; y <= 40; ++y)
      for (int x = -40; x <= 40; ++x) {
        cloud.positions.emplace_back(0.02f * static_cast<float>(x), 0.02f * static_cast<float>(y), -depth);
        cloud.normals.emplace_back(0, 0, 1);
        cloud.colors.push_back({static_cast<std::uint8_t>(depth == 0 ? 200 : 0),
                                static_cast<std::uint8_t>(depth == 0.05f ? 200 : 0),
                                static_cast<std::uint8_t>(depth == 0.5f ? 200 : 0), 255});
      }
  Camera camera;
  camera.eye = {0.1, 0.2, 3};
  const FrameOptions options{.pass = ImagePass::color, .splatRadius = 0.04, .raster = Raster::hardware};
  const DrawnCloud drawn(device, cloud);
  CHECK(checkSame(drawn, camera, options) > 0.3);
  Frame& frame = frameOf(kWidth, kHeight, 2);
  draw(frame, drawn, camera, options);
  const auto middle = frame.readColor().at(kWidth / 2, kHeight / 2);
  CHECK(middle[0] > 60);
  CHECK(middle[1] > 60);
  CHECK(middle[2] == 0);
}

TEST_CASE_FIXTURE(HardwareRasterFixture, "the hardware rasterizer gives the same picture bit by bit every time") {
  if (!drawsHere()) return;
  const PointCloud cloud = colored(shapeCloud("torus"));
  const DrawnCloud drawn(device, cloud, {.spacing = meanSpacing(cloud)}), plain(device, shapeCloud("cube"));
  const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
  Frame& frame = frameOf(kWidth, kHeight, 2);
  const auto shown = [&] {
    draw(frame, drawn, camera, {.raster = Raster::hardware});
    return frame.readColor().rgba;
  };
  const auto first = shown();
  draw(frame, plain, camera, {.splatRadius = 0.1, .raster = Raster::hardware});
  CHECK(shown() == first);
}

TEST_CASE_FIXTURE(HardwareRasterFixture,
                  "a hardware-rasterized frame names its passes and can be submitted repeatedly") {
  if (!drawsHere()) return;
  const PointCloud cloud = shapeCloud("sphere", 1000);
  const DrawnCloud drawn(device, cloud);
  Frame& frame = frameOf(kWidth, kHeight, 2);
  CommandList list(device, device.throughputQueue(), "frame", CommandList::Timing::passes);
  list.begin();
  frame.record(list, drawn, Camera::fitting(cloud, double{kWidth} / kHeight),
               {.splatRadius = 0.05, .raster = Raster::hardware});
  list.end();
  device.throughputQueue().run(list);
  const auto first = frame.readColor().rgba;
  for (int i = 0; i < 3; ++i) device.throughputQueue().run(list);
  CHECK(frame.readColor().rgba == first);
  std::vector<std::string> names;
  for (const PassRecord& pass : list.passes()) names.push_back(pass.section + ": " + pass.name);
  CHECK(names == std::vector<std::string>{"frame/splat: render_hardware_depth", "frame/splat: render_hardware_normals",
                                          "frame/splat: render_hardware_sums", "frame/holes: render_close_holes",
                                          "frame/shade: render_shade", "frame/shade: render_resolve"});
  CHECK(list.passes()[0].threads == 1024);  // vertices, in whole workgroups
}

TEST_CASE_FIXTURE(HardwareRasterFixture, "a picture larger than the GPU's images is refused with an alternative") {
  if (!drawsHere()) return;
  const std::uint32_t side = device.properties().limits.maxImageDimension2D + 1;
  CHECK_THROWS_WITH_AS(HardwareRaster(device, {side, 1}), doctest::Contains("raster compute"), UsageError);
  CHECK_THROWS_WITH_AS(rasterNamed("paint"), doctest::Contains("compute, hardware"), UsageError);
  CHECK(rasterNamed("hardware") == Raster::hardware);
}

}  // namespace palpate::hardware_raster_test
