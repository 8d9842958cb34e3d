#include <algorithm>
#include <glm/trigonometric.hpp>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "shaders/shared/ramp.h"
#include "tests/render/picture_fixture.hpp"

namespace palpate::picture_test {

namespace {

constexpr std::uint32_t kWidth = 160, kHeight = 120;

PointCloud sphereCloud(std::size_t count = 20'000) { return sampleShape(*makeShape("sphere", 2.0), {.count = count}); }

FrameOptions optionsFor(const PointCloud& cloud, ImagePass pass = ImagePass::final) {
  FrameOptions options;
  options.pass = pass;
  options.splatRadius = 1.95 * meanSpacing(cloud);
  return options;
}

DVec3 rayThrough(const Camera& camera, std::uint32_t x, std::uint32_t y) {
  const auto axes = camera.axes();
  const double focal = camera.focal_px(kHeight);
  return glm::normalize(axes.forward + (x + 0.5 - kWidth / 2.0) / focal * axes.right -
                        (y + 0.5 - kHeight / 2.0) / focal * axes.up);
}

DVec3 decodedNormal(const std::array<std::uint8_t, 4>& rgba) {
  return glm::normalize(DVec3(rgba[0], rgba[1], rgba[2]) / 127.5 - 1.0);
}

/// The colour at the pixel where `position` appears, 0 to 1.
DVec3 colorAt(const Image& image, const Camera& camera, const DVec3& position) {
  const auto place = camera.project(position, {image.width, image.height});
  REQUIRE(place);
  const auto& rgba = image.at(static_cast<std::uint32_t>(place->x), static_cast<std::uint32_t>(place->y));
  return DVec3(rgba[0], rgba[1], rgba[2]) / 255.0;
}

}  // namespace

TEST_CASE_FIXTURE(PictureFixture, "pictures that are recorded before the first of them is drawn keep their cameras") {
  const PointCloud cloud = sphereCloud(2000);
  const DrawnCloud drawn(device, cloud);
  const FrameOptions options = optionsFor(cloud);
  Camera near = Camera::fitting(cloud, double{kWidth} / kHeight), far = near;
  far.eye *= 1.5;
  Frame& frame = frameOf(kWidth, kHeight, 2);
  CommandList first(device, device.throughputQueue(), "first"), second(device, device.throughputQueue(), "second");
  first.begin();
  frame.record(first, drawn, near, options);
  first.end();
  second.begin();
  frame.record(second, drawn, far, options);
  second.end();
  device.throughputQueue().run(first);
  const Image ofFirst = frame.readColor();
  device.throughputQueue().run(second);
  const Image ofSecond = frame.readColor();
  CHECK(ofFirst.rgba != ofSecond.rgba);
  draw(frame, drawn, near, options);
  CHECK(frame.readColor().rgba == ofFirst.rgba);
  draw(frame, drawn, far, options);
  CHECK(frame.readColor().rgba == ofSecond.rgba);
}

TEST_CASE_FIXTURE(PictureFixture, "the picture of a sphere has no holes and true depths and normals") {
  const PointCloud cloud = sphereCloud();
  const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
  Frame& frame = frameOf(kWidth, kHeight, 2);
  draw(frame, DrawnCloud(device, cloud), camera, optionsFor(cloud, ImagePass::normal));
  const Image image = frame.readColor();
  const DepthImage depths = frame.readDepth();
  const double pixel = 2 * glm::length(camera.eye) / camera.focal_px(kHeight);  // two pixels at the sphere
  std::size_t inside = 0, holes = 0, wrongDepths = 0, wrongNormals = 0;
  double worst_deg = 0;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const DVec3 ray = rayThrough(camera, x, y);
      const double along = -glm::dot(ray, camera.eye);
      const double offset = glm::length(camera.eye + along * ray);
      if (offset > 1 - pixel) continue;
      ++inside;
      const DVec3 hit = camera.eye + (along - std::sqrt(1 - offset * offset)) * ray;
      const double depth = glm::dot(hit - camera.eye, camera.axes().forward);
      holes += depths.at(x, y) == 0;
      // Half a pixel of slope, plus the height of a disc's rim above the sphere.
      wrongDepths += std::abs(depths.at(x, y) - depth) > pixel * std::sqrt(1 / (1 - offset * offset)) + 0.002;
      const double angle_deg =
          glm::degrees(std::acos(std::clamp(glm::dot(decodedNormal(image.at(x, y)), glm::normalize(hit)), -1.0, 1.0)));
      wrongNormals += angle_deg > 5;
      worst_deg = std::max(worst_deg, angle_deg);
    }
  }
  CAPTURE(worst_deg);
  CHECK(inside > 3000);
  CHECK(holes == 0);
  CHECK(wrongDepths == 0);
  CHECK(wrongNormals == 0);
}

TEST_CASE_FIXTURE(PictureFixture, "the depth of a pixel is that of its nearest sample") {
  const PointCloud cloud = sphereCloud(3000);
  const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
  const FrameOptions options = optionsFor(cloud, ImagePass::depth);
  const DrawnCloud drawn(device, cloud);
  Frame& samples = frameOf(kWidth, kHeight, 1);
  draw(samples, drawn, camera, options);
  const DepthImage each = samples.readDepth();
  Frame& pixels = frameOf(kWidth / 2, kHeight / 2, 2);
  draw(pixels, drawn, camera, options);
  const DepthImage all = pixels.readDepth();
  std::size_t outlines = 0, wrong = 0;
  for (std::uint32_t y = 0; y < all.height; ++y)
    for (std::uint32_t x = 0; x < all.width; ++x) {
      float nearest = 0;
      int background = 0;
      for (std::uint32_t k = 0; k < 4; ++k) {
        const float depth = each.at(2 * x + k % 2, 2 * y + k / 2);
        background += depth == 0;
        if (depth > 0) nearest = nearest > 0 ? std::min(nearest, depth) : depth;
      }
      outlines += background > 0 && background < 4;
      wrong += all.at(x, y) != nearest;
    }
  CHECK(outlines > 50);
  CHECK(wrong == 0);
}

TEST_CASE_FIXTURE(PictureFixture, "smoothed depth gives normals, keeps steps and leaves the background unchanged") {
  PointCloud cloud = sphereCloud();
  const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
  Frame& frame = frameOf(kWidth, kHeight, 1);
  FrameOptions options = optionsFor(cloud, ImagePass::normal);
  options.splatRadius = 0.03;
  draw(frame, DrawnCloud(device, cloud), camera, options);
  const DepthImage raw = frame.readDepth();
  options.smooth_px = 2;
  draw(frame, DrawnCloud(device, cloud), camera, options);
  const DepthImage smooth = frame.readDepth();
  const Image image = frame.readColor();
  std::size_t inside = 0, moved = 0, wrongNormals = 0, torn = 0;
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      torn += (raw.at(x, y) == 0) != (smooth.at(x, y) == 0);
      const DVec3 ray = rayThrough(camera, x, y);
      const double along = -glm::dot(ray, camera.eye), offset = glm::length(camera.eye + along * ray);
      if (offset > 0.9) continue;
      ++inside;
      const DVec3 hit = camera.eye + (along - std::sqrt(1 - offset * offset)) * ray;
      const double depth = glm::dot(hit - camera.eye, camera.axes().forward);
      moved += std::abs(smooth.at(x, y) - depth) > 0.01;
      wrongNormals += angleBetween_deg(decodedNormal(image.at(x, y)), hit) > 12;
    }
  CHECK(inside > 3000);
  CHECK(torn == 0);
  CHECK(moved == 0);
  CHECK(wrongNormals < inside / 50);

  // Two sheets, one far behind the other: no depth between them may appear.
  cloud.positions.clear();
  for (int y = -60; y <= 60; ++y)
    for (int x = -60; x <= 60; ++x)
      cloud.positions.emplace_back(0.02f * static_cast<float>(x), 0.02f * static_cast<float>(y), x < 0 ? 0.0f : -1.0f);
  cloud.normals.assign(cloud.positions.size(), Vec3(0, 0, 1));
  Camera front;
  front.eye = {0, 0, 3};
  draw(frame, DrawnCloud(device, cloud), front, options);
  const DepthImage step = frame.readDepth();
  CHECK(std::ranges::none_of(step.depth, [](float d) { return d > 3.01f && d < 3.99f; }));
  CHECK(imagePassNamed("smooth-depth") == ImagePass::smoothDepth);
}

TEST_CASE_FIXTURE(PictureFixture, "a surface is lit on the visible side") {
  PointCloud cloud = sampleShape(*makeShape("plane", 2.0), {.count = 3000});
  Camera camera;
  for (const double side : {1.0, -1.0}) {
    camera.eye = {0.3, 0.2, 3 * side};
    const Image image = picture(cloud, camera, optionsFor(cloud, ImagePass::normal), kWidth, kHeight);
    CHECK(glm::distance(colorAt(image, camera, DVec3(0)), 0.5 + 0.5 * DVec3(0, 0, side)) < 0.02);
  }
}

TEST_CASE_FIXTURE(PictureFixture,
                  "with hidden backs one looks through a ceiling onto the floor, and through the floor from below") {
  PointCloud room;  // a red ceiling that faces down over a green floor that faces up
  for (const float height : {1.0f, -1.0f})
    for (int x = -20; x <= 20; ++x)
      for (int z = -20; z <= 20; ++z) {
        room.positions.emplace_back(0.05f * static_cast<float>(x), height, 0.05f * static_cast<float>(z));
        room.normals.emplace_back(0.0f, -height, 0.0f);
        room.colors.push_back(height > 0 ? std::array<std::uint8_t, 4>{200, 0, 0, 255}
                                         : std::array<std::uint8_t, 4>{0, 200, 0, 255});
      }
  const auto isRed = [&](double eye, FrameOptions options) {
    const Camera camera = Camera::parse(fmt::format("eye=0,{},0.1 target=0,0,0", eye), room, 1);
    const auto middle = picture(room, camera, options, 64, 64).at(32, 32);
    CHECK(std::max(middle[0], middle[1]) > 150);
    return middle[0] > middle[1];
  };
  for (const Raster raster : {Raster::compute, Raster::hardware}) {
    if (raster == Raster::hardware && !device.draws()) continue;
    CHECK(isRed(6, {.pass = ImagePass::color, .splatRadius = 0.08, .raster = raster}));
    CHECK_FALSE(isRed(6, {.pass = ImagePass::color, .splatRadius = 0.08, .raster = raster, .hidesBacks = true}));
    CHECK_FALSE(isRed(-6, {.pass = ImagePass::color, .splatRadius = 0.08, .raster = raster}));
    CHECK(isRed(-6, {.pass = ImagePass::color, .splatRadius = 0.08, .raster = raster, .hidesBacks = true}));
  }
}

TEST_CASE_FIXTURE(PictureFixture, "the back of an open surface is lit as its inside, also if it is seen obliquely") {
  for (const double facing : {-0.95, -0.6, -0.48}) {
    CAPTURE(facing);
    const DVec3 normal(std::sqrt(1 - facing * facing), 0, facing), along(-facing, 0, normal.x);
    PointCloud plate;
    for (int x = -20; x <= 20; ++x)
      for (int y = -20; y <= 20; ++y) {
        plate.positions.emplace_back(0.05 * x * along + DVec3(0, 0.05 * y, 0));
        plate.normals.emplace_back(normal);
      }
    const Camera camera = Camera::parse("eye=0,0,100 target=0,0,0 fov=2", plate, 1);
    const Image image = picture(plate, camera, {.pass = ImagePass::normal, .splatRadius = 0.08}, 64, 64);
    CHECK(glm::dot(decodedNormal(image.at(32, 32)), -normal) > 0.99);
  }
}

TEST_CASE_FIXTURE(PictureFixture, "the same cloud gives the same picture bit by bit every time") {
  const PointCloud cloud = sphereCloud();
  const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
  const Image first = picture(cloud, camera, optionsFor(cloud), kWidth, kHeight);
  const Image second = picture(cloud, camera, optionsFor(cloud), kWidth, kHeight);
  CHECK(first.rgba == second.rgba);
}

TEST_CASE_FIXTURE(PictureFixture, "the background has exactly the requested colour") {
  PointCloud cloud;
  cloud.positions = {Vec3(0)};
  FrameOptions options;
  options.background = {12, 200, 77};
  const Image image = picture(cloud, Camera::fitting(cloud, double{kWidth} / kHeight), options, kWidth, kHeight);
  CHECK(std::ranges::count(image.rgba, std::array<std::uint8_t, 4>{12, 200, 77, 255}) >= kWidth * kHeight - 4);
}

TEST_CASE_FIXTURE(PictureFixture, "the colour image shows the file's colours") {
  PointCloud cloud = sphereCloud(4000);
  for (const Vec3& p : cloud.positions)
    cloud.colors.push_back(p.x < 0 ? std::array<std::uint8_t, 4>{200, 30, 40, 255}
                                   : std::array<std::uint8_t, 4>{20, 90, 220, 255});
  const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
  const Image image = picture(cloud, camera, optionsFor(cloud, ImagePass::color), kWidth, kHeight);
  CHECK(glm::distance(colorAt(image, camera, {-0.5, 0, 0.8}), DVec3(200, 30, 40) / 255.0) < 0.02);
  CHECK(glm::distance(colorAt(image, camera, {0.5, 0, 0.8}), DVec3(20, 90, 220) / 255.0) < 0.02);
}

TEST_CASE_FIXTURE(PictureFixture, "a crowd at one position keeps its colour and its normal") {
  PointCloud cloud;
  const Vec3 normal = glm::normalize(Vec3(1, 2, 3));
  cloud.positions.assign(300'000, Vec3(0));
  cloud.normals.assign(cloud.size(), normal);
  cloud.colors.assign(cloud.size(), {250, 130, 3, 255});
  Camera camera;
  camera.eye = {0.1, 0.2, 3};
  FrameOptions options;
  options.splatRadius = 0.01;
  options.pass = ImagePass::color;
  const DVec3 color = colorAt(picture(cloud, camera, options, kWidth, kHeight, 1), camera, DVec3(0));
  CHECK(glm::distance(color, DVec3(250, 130, 3) / 255.0) < 0.01);
  options.pass = ImagePass::normal;
  const DVec3 shown = colorAt(picture(cloud, camera, options, kWidth, kHeight, 1), camera, DVec3(0));
  CHECK(glm::distance(shown, 0.5 + 0.5 * DVec3(normal)) < 0.01);
}

TEST_CASE_FIXTURE(
    PictureFixture,
    "a sheet seen from its back keeps its colour up to the rims of its discs, with any number of points") {
  const PointCloud cloud = backBesideCrowd();
  Camera camera;
  camera.eye = {0, 0, 3};
  FrameOptions options;
  options.splatRadius = 0.5;
  options.pass = ImagePass::color;
  const Image image = picture(cloud, camera, options, kWidth, kHeight, 1);
  for (const double x : {0.0, 0.2, 0.4, 0.46})
    CHECK(glm::distance(colorAt(image, camera, {x, 0, 0}), DVec3(200, 100, 60) / 255.0) < 0.06);
}

TEST_CASE_FIXTURE(PictureFixture, "every pass and every colouring produces a picture") {
  const PointCloud cloud = sphereCloud(2000);
  const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
  std::vector<Image> seen;
  for (const auto pass : {ImagePass::final, ImagePass::depth, ImagePass::normal, ImagePass::color, ImagePass::position})
    seen.push_back(picture(cloud, camera, optionsFor(cloud, pass), kWidth, kHeight));
  for (const auto color : {ColorSource::normal, ColorSource::depth, ColorSource::height}) {
    FrameOptions options = optionsFor(cloud);
    options.color = color;
    seen.push_back(picture(cloud, camera, options, kWidth, kHeight));
  }
  for (std::size_t i = 0; i < seen.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) CHECK(seen[i].rgba != seen[j].rgba);
}

TEST_CASE_FIXTURE(CoreValidated<PictureFixture>, "colours by height follow the up axis and span the shown range") {
  const PointCloud cloud = sphereCloud(4000);
  FrameOptions options = optionsFor(cloud, ImagePass::color);
  options.color = ColorSource::height;
  const auto close = [](const DVec3& seen, float share) {
    return glm::distance(seen, DVec3(shared::rampColor(shared::kMapTerrain, share))) < 0.04;
  };
  for (const auto& [name, up] : kUpAxes) {
    CAPTURE(name);
    const Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight, 45, {.up = up});
    options.up = directionOf(up);
    options.shown.reset();
    const Image image = picture(cloud, camera, options, kWidth, kHeight);
    for (const double height : {-0.5, 0.0, 0.7}) {
      CAPTURE(height);
      const DVec3 at = height * directionOf(up) + std::sqrt(1 - height * height) * frontOf(up);
      CHECK(close(colorAt(image, camera, at), static_cast<float>(0.5 + 0.5 * height)));
    }
    options.shown = Bounds{DVec3(-0.5), DVec3(0.5)};
    const Image half = picture(cloud, camera, options, kWidth, kHeight);
    for (const double height : {-0.7, 0.25, 0.8}) {
      CAPTURE(height);
      const DVec3 at = height * directionOf(up) + std::sqrt(1 - height * height) * frontOf(up);
      CHECK(close(colorAt(half, camera, at), static_cast<float>(0.5 + height)));
    }
  }
}

TEST_CASE_FIXTURE(PictureFixture, "gaps as wide as a splat are closed, and windows are not") {
  const auto gridWithHole = [](float hole) {
    PointCloud cloud;
    for (int y = -40; y <= 40; ++y)
      for (int x = -40; x <= 40; ++x)
        if (const Vec3 p(0.025f * static_cast<float>(x), 0.025f * static_cast<float>(y), 0); glm::length(p) >= hole)
          cloud.positions.push_back(p);
    cloud.normals.assign(cloud.size(), Vec3(0, 0, 1));
    return cloud;
  };
  FrameOptions options;
  options.splatRadius = 0.05;
  options.background = {0, 0, 0};
  Camera camera;
  camera.eye = {0, 0, 3};
  CHECK(colorAt(picture(gridWithHole(0.08f), camera, options, kWidth, kHeight), camera, DVec3(0)).r > 0.2);
  CHECK(colorAt(picture(gridWithHole(0.3f), camera, options, kWidth, kHeight), camera, DVec3(0)).r == 0);
  options.closeHoles = false;
  CHECK(colorAt(picture(gridWithHole(0.08f), camera, options, kWidth, kHeight), camera, DVec3(0)).r == 0);
}

TEST_CASE_FIXTURE(PictureFixture, "ball, disc and arrow are visible in front, and shine through from behind") {
  const PointCloud cloud = sphereCloud(5000);
  Camera camera;
  camera.eye = {0, 0, 4};
  camera.nearDepth = 0.1;
  for (const std::uint32_t supersample : {1u, 2u}) {
    CAPTURE(supersample);
    const auto shown = [&](const Overlays& overlays, const DVec3& at) {
      FrameOptions options = optionsFor(cloud);
      options.overlays = overlays;
      return colorAt(picture(cloud, camera, options, kWidth, kHeight, supersample), camera, at);
    };
    const DVec3 bare = shown({}, {0, 0, 0});
    const DVec3 front = shown({.hip = Overlays::Ball{{0, 0, 1.2}, 0.15}}, {0, 0, 1.2});
    const DVec3 hidden = shown({.hip = Overlays::Ball{{0, 0, 0.5}, 0.15}}, {0, 0, 0.5});
    CHECK(front.r > front.b + 0.4);
    CHECK(hidden.r - hidden.b > bare.r - bare.b + 0.1);
    CHECK(hidden.r - hidden.b < front.r - front.b - 0.1);
    const DVec3 disc = shown({.proxy = Overlays::Disc{{0.3, 0, 1.05}, {0, 0, 1}, 0.2}}, {0.3, 0, 1.05});
    CHECK(disc.b > disc.r + 0.3);
    const DVec3 shaft = shown({.force = Overlays::Arrow{{0, -0.2, 1.2}, {0, 1, 0}, 0.04}}, {0, 0.3, 1.2});
    CHECK(shaft.r > shaft.g + 0.3);
    const DVec3 head = shown({.force = Overlays::Arrow{{0, -0.2, 1.2}, {0, 1, 0}, 0.04}}, {0.05, 0.62, 1.2});
    CHECK(head.r > head.g + 0.2);
    const DVec3 past = shown({.force = Overlays::Arrow{{0, -0.2, 1.2}, {0, 1, 0}, 0.04}}, {0, 0.84, 1.2});
    CHECK(std::abs(past.r - past.g) < 0.1);
  }
}

TEST_CASE_FIXTURE(CoreValidated<PictureFixture>,
                  "the tool is drawn as a ring and the scale bar from end to end, before and behind the surface") {
  const PointCloud cloud = sphereCloud(5000);
  Camera camera;
  camera.eye = {0, 0, 4};
  camera.nearDepth = 0.1;
  const auto shown = [&](const Overlays& overlays, const DVec3& at) {
    FrameOptions options = optionsFor(cloud);
    options.overlays = overlays;
    return colorAt(picture(cloud, camera, options, kWidth, kHeight), camera, at);
  };
  const auto yellow = [](const DVec3& color) { return std::min(color.r, color.g) - color.b; };
  const Overlays brush{.brush = Overlays::Ball{{0, 0, 1.2}, 0.6}};
  const Overlays behind{.brush = Overlays::Ball{{0, 0, -0.5}, 0.6}};
  const DVec3 rim(0.585, 0, 1.2), hiddenRim(0, 0.585, -0.5), middle(0.3, 0, 1.2);
  CHECK(yellow(shown(brush, rim)) > yellow(shown({}, rim)) + 0.15);
  CHECK(glm::distance(shown(brush, middle), shown({}, middle)) < 0.01);
  const double full = yellow(shown(brush, rim)) - yellow(shown({}, rim));
  const double through = yellow(shown(behind, hiddenRim)) - yellow(shown({}, hiddenRim));
  CHECK(through > 0.02);
  CHECK(through < full);

  const Overlays bar{.scale = Overlays::Bar{{-0.4, -0.2, 1.2}, {0.8, 0, 0}, 0.03}};
  const Overlays hiddenBar{.scale = Overlays::Bar{{-0.4, -0.2, 0}, {0.8, 0, 0}, 0.03}};
  for (const double x : {-0.39, -0.2, 0.1, 0.39}) {
    const DVec3 at(x, -0.2, 1.2);
    CHECK(shown(bar, at).b > shown({}, at).b + 0.1);
  }
  for (const double x : {-0.5, 0.5}) {
    const DVec3 at(x, -0.2, 1.2);
    CHECK(glm::distance(shown(bar, at), shown({}, at)) < 0.01);
  }
  const DVec3 tick(0.385, -0.13, 1.2);  // the discs at its ends are wider
  CHECK(glm::distance(shown(bar, tick), shown({}, tick)) > 0.05);
  const DVec3 inside(0.1, -0.2, 0);
  CHECK(shown(hiddenBar, inside).b > shown({}, inside).b + 0.02);
  CHECK(shown(hiddenBar, inside).b < shown(bar, {0.1, -0.2, 1.2}).b);
}

TEST_CASE_FIXTURE(PictureFixture, "picture sizes that cannot be drawn are refused") {
  CHECK_THROWS_AS(Frame(device, 0, 10), UsageError);
  CHECK_THROWS_AS(Frame(device, 10, 100'000), UsageError);
  CHECK_THROWS_WITH_AS(imagePassNamed("nose"), doctest::Contains("final, depth, smooth-depth, normal, color, position"),
                       UsageError);
  CHECK(imagePassNamed("position") == ImagePass::position);
}

TEST_CASE_FIXTURE(CoreValidated<PictureFixture>, "a picture preempted by touch is the same bit by bit") {
  for (const std::size_t count : {std::size_t{1}, std::size_t{257}, std::size_t{20'000}}) {
    CAPTURE(count);
    const PointCloud cloud = sphereCloud(count);
    Camera camera = Camera::fitting(cloud, double{kWidth} / kHeight);
    for (const double closer : {1.0, 0.4}) {  // small discs, and large ones
      camera.eye = camera.target + closer * (camera.eye - camera.target);
      camera.setDepthRange(boundsOf(cloud), boundsOf(cloud).longestSide());
      FrameOptions options;
      options.splatRadius = count == 1 ? 0.5 : 1.95 * meanSpacing(cloud);
      const Image alone = picture(cloud, camera, options, kWidth, kHeight);
      device.noteUrgentWork(1);
      const Image touched = picture(cloud, camera, options, kWidth, kHeight);
      device.noteUrgentWork(-1);
      CHECK(alone.rgba == touched.rgba);
    }
  }
}

TEST_CASE_FIXTURE(PictureFixture, "a frame names its passes") {
  const PointCloud cloud = sphereCloud(100);
  Frame& frame = frameOf(kWidth, kHeight, 2);
  const DrawnCloud drawn(device, cloud);
  CommandList list(device, device.throughputQueue(), "frame", CommandList::Timing::passes);
  list.begin();
  frame.record(list, drawn, Camera::fitting(cloud, double{kWidth} / kHeight), optionsFor(cloud));
  list.end();
  device.throughputQueue().run(list);
  std::vector<std::string> names;
  for (const PassRecord& pass : list.passes()) names.push_back(pass.section + ": " + pass.name);
  const std::string attributes = device.hasWideAtomics() ? "render_splat_attributes_wide" : "render_splat_attributes";
  std::vector<std::string> expected{"frame/clear: fill frame depth", "frame/clear: fill frame normal sums",
                                    "frame/splat: fill splat counts", "frame/splat: render_splat_pick",
                                    "frame/splat: render_splat_plan"};
  for (const std::string& pass : {std::string("render_splat_depth"), attributes})  // over small splats and large ones
    expected.insert(expected.end(), 2, "frame/splat: " + pass);
  for (const char* pass :
       {"frame/holes: render_close_holes", "frame/shade: render_shade", "frame/shade: render_resolve"})
    expected.emplace_back(pass);
  CHECK(names == expected);
}

}  // namespace palpate::picture_test
