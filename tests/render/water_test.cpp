// Water in a picture: each pass against double precision, and what a user sees of it.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <glm/packing.hpp>

#include "engine/gpu/transfer.hpp"
#include "shaders/shared/water.h"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/render/picture_fixture.hpp"
#include "tests/render/water_reference.hpp"

namespace palpate::water_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

/// A lattice of `counts` particles from a corner, a little out of place.
PointCloud lattice(const DVec3& corner, const IVec3& counts, double off = 0.2) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-off, off);
  PointCloud cloud;
  for (int x = 0; x < counts.x; ++x)
    for (int y = 0; y < counts.y; ++y)
      for (int z = 0; z < counts.z; ++z) {
        const double dx = unit(random), dy = unit(random), dz = unit(random);
        cloud.positions.emplace_back(corner + kSpacing * (DVec3(x + 0.5, y + 0.5, z + 0.5) + DVec3(dx, dy, dz)));
        cloud.normals.emplace_back(0, 0, 1);
      }
  return cloud;
}

Camera fromFront(double height = 0) {
  Camera camera{.eye = {0.2, 0.1, 4}, .target = {0.1, 0, 0}, .height = height};
  camera.nearDepth = 0.1;
  return camera;
}

class WaterFixture : public PictureFixture {
 public:
  using PictureFixture::PictureFixture;

 protected:
  Buffer uploaded(const auto& values, const char* name) {
    using Value = typename std::decay_t<decltype(values)>::value_type;
    Buffer buffer = Buffer::of<Value>(device, values.size(), Memory::device, name);
    upload(device, device.throughputQueue(), buffer, values);
    return buffer;
  }
  void run(Passes& p) {
    const Bounds bounds{DVec3(-1), DVec3(1)};
    FrameOptions options;
    options.background = {255, 255, 255};
    const Drawn about{.bounds = bounds,
                      .count = static_cast<std::uint32_t>(p.positions.size()),
                      .hasColors = false,
                      .widest = 0,
                      .splatRadius = 0,
                      .widestSplat = 0.1,
                      .usualRadius = 0.1,
                      .spacing = kSpacing,
                      .closeHoles = false,
                      .inSample = 1,
                      .everyPoint = true};
    ConstantBlock frame(device, sizeof(shared::RenderFrame), 1, "constants");
    frame.write(0, frameConstants(about, p.camera, options, p.size, 0));
    std::vector<Vec4> places;
    for (const Vec3& at : p.positions) places.emplace_back(at, 0.f);
    std::vector<std::uint32_t> own(p.depths.size());
    for (std::uint32_t i = 0; i < own.size(); ++i) own[i] = i;
    std::vector<UVec2> light;
    for (const Vec4& l : p.lights) light.emplace_back(glm::packHalf2x16({l.r, l.g}), glm::packHalf2x16({l.b, l.a}));
    const Buffer positions = uploaded(places, "positions"), source = uploaded(own, "source"),
                 depth = uploaded(p.depths, "depths"), behind = uploaded(light, "light");
    WaterPass pass(device, p.size);
    p.particles = {.positions = positions.address(),
                   .count = static_cast<std::uint32_t>(p.positions.size()),
                   .radius = kRadius,
                   .spacing = kSpacing,
                   .side = 2};
    CommandList list(device, device.throughputQueue(), "test water");
    list.begin();
    list.use(frame, 0);
    pass.record(list, p.particles, {source.address(), depth.address(), behind.address()});
    list.end();
    device.throughputQueue().run(list);
    const std::size_t pixels = std::size_t{p.size.width} * p.size.height;
    Queue& queue = device.throughputQueue();
    p.fronts = download<std::uint32_t>(device, queue, pass.fronts(), pixels);
    p.sums = download<std::uint32_t>(device, queue, pass.sums(), pixels);
    p.smoothed = download<UVec2>(device, queue, pass.smoothed(), pixels);
    p.tidied = download<UVec2>(device, queue, pass.tidied(), pixels);
    p.surface = download<std::uint32_t>(device, queue, pass.surface(), p.depths.size());
    p.shaded = download<UVec2>(device, queue, pass.shaded(), p.depths.size());
  }
};

/// Water before a plate that covers the right half, with a part of the plate and a narrow rod in its surface.
Passes strewn(const UVec2& size_px, std::uint32_t supersample, bool orthographic) {
  Passes p{.camera = fromFront(orthographic ? 2.5 : 0),
           .size = {.width = size_px.x, .height = size_px.y, .supersample = supersample}};
  p.positions = lattice({-0.6, -0.5, -0.3}, {10, 8, 5}).positions;
  for (const Vec3 drop : {Vec3(0.8, 0.6, 0.4), Vec3(-0.9, 0.1, -0.6), Vec3(0.1, 0.1, 1.2), Vec3(0, 0, 3.95)})
    p.positions.push_back(drop);
  for (std::uint32_t y = 0; y < size_px.y * supersample; ++y)
    for (std::uint32_t x = 0; x < size_px.x * supersample; ++x) {
      const bool isRight = 2 * x > size_px.x * supersample, isLow = 4 * y > 3 * size_px.y * supersample;
      const bool isRod = x / supersample == 2 * size_px.x / 5;  // narrow, where the water begins
      const float depth = isRod ? 3.78f : isRight ? (isLow ? 3.2f : 5.f) : std::numeric_limits<float>::infinity();
      p.depths.push_back(std::bit_cast<std::uint32_t>(depth));
      p.lights.emplace_back(isRight ? 0.7f : 0.2f, 0.3f, 0.1f + 0.02f * static_cast<float>(x % 20),
                            isRight ? 1.f : 0.5f);
    }
  return p;
}

}  // namespace

TEST_CASE_FIXTURE(CoreValidated<WaterFixture>, "each pass of water is that of double precision, at any size") {
  struct Case {
    UVec2 size_px;
    std::uint32_t supersample;
    bool orthographic;
  };
  for (const Case& c : {Case{{67, 51}, 1, false}, Case{{67, 51}, 2, false}, Case{{40, 33}, 2, true},
                        Case{{1, 1}, 2, false}, Case{{3, 70}, 1, false}, Case{{130, 2}, 1, false}}) {
    CAPTURE(c.size_px.x);
    CAPTURE(c.size_px.y);
    Passes p = strewn(c.size_px, c.supersample, c.orthographic);
    run(p);
    const std::size_t pixels = std::size_t{c.size_px.x} * c.size_px.y;
    const Surface balls = ballsOf(p);
    const double unit = 1 / (WaterPass::unitsInLength(p.particles) * p.particles.side);
    Surface gpu = balls;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      gpu.depth[i] = double{std::bit_cast<float>(p.fronts[i])};
      gpu.thickness[i] = p.sums[i] * unit;
      gpu.cover[i] = gpu.depth[i] < kNone ? 1 : 0;
      // A ray that grazes a ball may miss it.
      const bool same = gpu.depth[i] < kNone && balls.depth[i] < kNone ? std::abs(gpu.depth[i] - balls.depth[i]) < 1e-3
                                                                       : gpu.depth[i] == balls.depth[i];
      wrong += !same ||
               std::abs(gpu.thickness[i] - balls.thickness[i]) > 1e-3 + 0.5 * unit * balls.cover[i];  // each is rounded
    }
    CHECK(wrong <= pixels / 500);

    Surface smooth = smoothedAlong(p, smoothedAlong(p, gpu, false), true), ofGpu = smooth;
    wrong = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      const double front = gpu.depth[i];
      if (front < kNone)
        smooth.depth[i] = std::clamp(smooth.depth[i], front - double{shared::kWaterNearer} * kRadius,
                                     front + double{shared::kWaterFarther} * kRadius);
      const Vec2 amount = glm::unpackHalf2x16(p.smoothed[i].y);
      ofGpu.depth[i] = double{std::bit_cast<float>(p.smoothed[i].x)};
      ofGpu.thickness[i] = double{amount.x}, ofGpu.cover[i] = double{amount.y};
      const bool same =
          smooth.depth[i] == kNone ? ofGpu.depth[i] == kNone : std::abs(ofGpu.depth[i] - smooth.depth[i]) < 1e-3;
      wrong += !same || std::abs(ofGpu.thickness[i] - smooth.thickness[i]) > 1e-3 ||
               std::abs(ofGpu.cover[i] - smooth.cover[i]) > 2e-3;
    }
    CHECK(wrong <= pixels / 200);

    const Surface tidy = tidied(p, ofGpu);
    wrong = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      ofGpu.depth[i] = double{std::bit_cast<float>(p.tidied[i].x)};
      wrong += tidy.depth[i] == kNone ? ofGpu.depth[i] != kNone : !(std::abs(ofGpu.depth[i] - tidy.depth[i]) < 1e-3);
      CHECK(p.tidied[i].y == p.smoothed[i].y);
    }
    CHECK(wrong <= pixels / 200);

    wrong = 0;
    for (std::uint32_t y = 0; y < c.size_px.y * c.supersample; ++y)
      for (std::uint32_t x = 0; x < p.across(); ++x) {
        const std::size_t place = std::size_t{y} * p.across() + x;
        const Vec2 rg = glm::unpackHalf2x16(p.shaded[place].x), ba = glm::unpackHalf2x16(p.shaded[place].y);
        const DVec4 expected = composed(p, ofGpu, x, y);
        const DVec4 light(DVec3(rg.x, rg.y, ba.x) * double{ba.y}, ba.y);
        for (int k = 0; k < 4; ++k) wrong += std::abs(light[k] - expected[k]) > 4e-3 + 0.01 * std::abs(expected[k]);
      }
    CHECK(wrong <= p.depths.size() / 1000);
  }
}

TEST_CASE_FIXTURE(WaterFixture, "water is as thick as it is, and lets through what Beer and Lambert say") {
  for (const int layers : {4, 12}) {
    // A slab across the whole picture, seen from the front, before a white wall.
    Passes p{.camera = fromFront(1), .size = {.width = 48, .height = 48, .supersample = 1}};
    p.camera.eye = {0, 0, 4}, p.camera.target = DVec3(0);
    p.positions = lattice({-1, -1, -0.05 * layers}, {20, 20, layers}, 0).positions;
    p.depths.assign(48 * 48, std::bit_cast<std::uint32_t>(10.f));
    p.lights.assign(48 * 48, Vec4(1, 1, 1, 1));
    run(p);
    DVec3 light(0);
    double thickness = 0;
    constexpr int kFrom = 12, kTo = 36;
    for (int y = kFrom; y < kTo; ++y)
      for (int x = kFrom; x < kTo; ++x) {
        const std::size_t i = static_cast<std::size_t>(48 * y + x);
        thickness += double{glm::unpackHalf2x16(p.smoothed[i].y).x} * p.particles.side;
        light += DVec3(glm::unpackHalf2x16(p.shaded[i].x), glm::unpackHalf2x16(p.shaded[i].y).x);
      }
    constexpr double kCount = (kTo - kFrom) * (kTo - kFrom);
    CHECK(thickness / kCount == near(kSpacing * layers, 0.03));
    const DVec3 passes = glm::exp(-DVec3(shared::kWaterAbsorption) * (kSpacing * layers / p.particles.side));
    const DVec3 own = lightOfWater((1.0 - passes) * DVec3(0.02, 0.20, 0.40), {0, 0, -1}, {0, 0, -1});
    for (int k = 0; k < 3; ++k) CHECK(light[k] / kCount == within(own[k] + 0.98 * passes[k], 0.03));
  }
}

namespace {

FrameOptions waterOptions(std::uint32_t standing = 0) {
  FrameOptions options;
  options.light.material = Material::water;
  options.particles = {.radius = kRadius, .spacing = kSpacing, .standing = standing};
  options.splatRadius = kRadius;
  return options;
}

/// A vertical plate of 21 x 21 points at this depth, red.
void addPlate(PointCloud& cloud, double z) {
  if (cloud.colors.empty()) cloud.colors.assign(cloud.size(), {90, 90, 90, 255});
  for (int x = -10; x <= 10; ++x)
    for (int y = -10; y <= 10; ++y) {
      cloud.positions.emplace_back(0.08 * x, 0.08 * y, z);
      cloud.normals.emplace_back(0, 0, 1);
      cloud.colors.push_back({220, 40, 30, 255});
    }
}

}  // namespace

TEST_CASE_FIXTURE(CoreValidated<WaterFixture>,
                  "what stands before water hides it, and what stands behind is seen through it") {
  Camera camera{.eye = {0, 0, 4}, .target = DVec3(0)};
  camera.nearDepth = 0.1;
  const auto drawn = [&](double plate, const FrameOptions& options) {
    PointCloud cloud = lattice({-0.5, -0.5, -0.3}, {10, 10, 6});
    addPlate(cloud, plate);
    return picture(cloud, camera, options, 90, 90);
  };
  const auto plateAlone = [&](double plate) {
    PointCloud cloud;
    addPlate(cloud, plate);
    return picture(cloud, camera, waterOptions(441), 90, 90);
  };
  const Image before = drawn(0.6, waterOptions(441)), behind = drawn(-0.6, waterOptions(441));
  for (const Raster raster : {Raster::compute, Raster::hardware}) {
    FrameOptions options = waterOptions(441);
    options.raster = raster;
    const Image same = drawn(-0.6, options);
    int most = 0;
    for (std::size_t i = 0; i < same.rgba.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        most = std::max(most, std::abs(int{same.rgba[i][k]} - int{behind.rgba[i][k]}));
    CHECK(most < 40);  // at the rims of discs
  }
  const auto alone = plateAlone(0.6), wall = plateAlone(-0.6);
  for (int k = 0; k < 3; ++k) {
    const auto channel = static_cast<std::size_t>(k);
    CHECK(std::abs(int{before.at(45, 45)[channel]} - int{alone.at(45, 45)[channel]}) <= 4);
  }
  // Beside the water the wall is as without it; through the water it has lost red.
  CHECK(behind.at(24, 45) == wall.at(24, 45));
  CHECK(behind.at(45, 45)[0] < wall.at(45, 45)[0] - 20);
  CHECK(behind.at(45, 45)[0] > 40);

  // Fields, heights and all other passes show discs.
  FrameOptions discs = waterOptions(441), heights = discs;
  discs.pass = ImagePass::normal;
  FrameOptions clay = discs;
  clay.light.material = Material::clay;
  CHECK(drawn(0.6, discs).rgba == drawn(0.6, clay).rgba);
  heights.color = ColorSource::height;
  CHECK_FALSE(showsWater(heights));
}

TEST_CASE_FIXTURE(WaterFixture, "the surface of water passes its particles closely, and hidden ones are left out") {
  PointCloud cloud = lattice({-0.5, -0.5, -0.3}, {10, 10, 6});
  const Camera camera = fromFront();
  DrawnCloud drawn(device, cloud);
  Frame& frame = frameOf(95, 71, 2);
  draw(frame, drawn, camera, waterOptions());
  const DepthImage depths = frame.readDepth();
  Passes p{.camera = camera, .size = {.width = 95, .height = 71, .supersample = 2}};
  p.positions = cloud.positions;
  p.particles.side = 2;
  p.depths.assign(std::size_t{4} * 95 * 71, shared::kNoDepth);
  const Surface balls = ballsOf(p);
  std::size_t seen = 0, off = 0;
  for (std::uint32_t y = 0; y < 71; ++y)
    for (std::uint32_t x = 0; x < 95; ++x) {
      const double ball = balls.depth[std::size_t{y} * 95 + x], depth = double{depths.at(x, y)};
      if (depth == 0 || ball == kNone) continue;
      ++seen;
      off += std::abs(depth - ball) > kRadius;
      CHECK(depth == within(ball, 2.5 * kRadius));
    }
  CHECK(seen > 300);
  CHECK(off < seen / 20);
  const Image shown = frame.readColor();
  const std::vector<AttributeChange> hides{
      MaskFlip{.role = MaskRole::hidden, .points = PointSet::range(0, cloud.size())}};
  drawn.attributes().follow(hides);
  draw(frame, drawn, camera, waterOptions());
  CHECK(std::ranges::count_if(frame.readDepth().depth, [](float d) { return d > 0; }) == 0);
  const Image hidden = frame.readColor();
  CHECK(hidden.rgba == picture({}, camera, waterOptions(), 95, 71).rgba);
  CHECK(hidden.rgba != shown.rgba);
}

TEST_SUITE_END();

}  // namespace palpate::water_test
