// Masks and a field in pictures: a plane that faces the camera, whose left half has what its right half has not.
#include "engine/render/drawn_attributes.hpp"

#include <cmath>

#include "shaders/shared/ramp.h"
#include "tests/labels.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::drawn_attributes_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr std::uint32_t kSide_px = 64;
constexpr int kRow = 41;
constexpr std::array<std::uint8_t, 4> kGreen{40, 160, 80, 255};

PointCloud planeCloud(bool colored) {
  PointCloud cloud;
  for (int y = 0; y < kRow; ++y)
    for (int x = 0; x < kRow; ++x) {
      cloud.positions.emplace_back(static_cast<float>(x - kRow / 2) * 0.05f, static_cast<float>(y - kRow / 2) * 0.05f,
                                   0);
      cloud.normals.emplace_back(0, 0, 1);
      if (colored) cloud.colors.push_back(kGreen);
    }
  return cloud;
}

/// The points of the left half.
PointSet leftOf(const PointCloud& cloud) {
  PointSet left;
  for (std::size_t i = 0; i < cloud.size(); ++i) left.set(i, cloud.positions[i].x < -0.02f);
  return left;
}

struct Seen {
  Image color;
  DepthImage depth;

  DVec3 at(std::uint32_t x) const {
    const auto& pixel = color.rgba[std::size_t{kSide_px / 2} * kSide_px + x];
    return DVec3(pixel[0], pixel[1], pixel[2]) / 255.0;
  }
  bool isCovered(std::uint32_t x) const { return depth.depth[std::size_t{kSide_px / 2} * kSide_px + x] > 0; }
  DVec3 left() const { return at(kSide_px / 2 - 12); }
  DVec3 right() const { return at(kSide_px / 2 + 12); }
};

bool isColor(const DVec3& seen, const DVec3& expected) { return glm::distance(seen, expected) < 0.02; }
DVec3 encoded(const std::array<std::uint8_t, 4>& color) { return DVec3(color[0], color[1], color[2]) / 255.0; }
DVec3 tinted(const DVec3& color) {
  return glm::mix(color, DVec3(shared::kSelectedColor), static_cast<double>(shared::kSelectedShare));
}

double brightness(const DVec3& color) { return glm::dot(color, DVec3(0.2126, 0.7152, 0.0722)); }

class AttributesFixture : public PictureFixture {
 protected:
  Seen see(const DrawnCloud& cloud, const ColorBy& color = ColorSource::rgb, Raster raster = Raster::compute) {
    Frame& frame = frameOf(kSide_px, kSide_px, 1);
    FrameOptions options{
        .pass = ImagePass::color, .color = color, .colorMap = map_, .splatRadius = 0.04, .raster = raster};
    options.closeHoles = false;
    draw(frame, cloud, Camera{.eye = {0, 0, 3}}, options);
    return {frame.readColor(), frame.readDepth()};
  }
  std::vector<Raster> rasters() {
    if (!device.draws()) return {Raster::compute};
    return {Raster::compute, Raster::hardware};
  }
  ColorMap map_ = ColorMap::viridis;
};

}  // namespace

TEST_CASE_FIXTURE(AttributesFixture, "selected points are tinted and hidden ones are not drawn, until that is undone") {
  for (const bool colored : {false, true}) {
    const PointCloud cloud = planeCloud(colored);
    const DVec3 own = encoded(colored ? kGreen : kUnpainted);
    for (const Raster raster : rasters()) {
      CAPTURE(colored);
      CAPTURE(static_cast<int>(raster));
      DrawnCloud drawn(device, cloud);
      const std::uint64_t bytes = drawn.bytes();
      const Seen before = see(drawn, ColorSource::rgb, raster);
      CHECK(isColor(before.left(), own));
      CHECK(isColor(see(drawn, ColorSource::material, raster).left(), encoded(kUnpainted)));
      const std::vector<AttributeChange> selects{MaskFlip{.role = MaskRole::selected, .points = leftOf(cloud)}};
      const std::vector<AttributeChange> hides{MaskFlip{.role = MaskRole::hidden, .points = leftOf(cloud)}};
      const std::vector<AttributeChange> locks{MaskFlip{.role = MaskRole::locked, .points = leftOf(cloud)}};
      drawn.attributes().follow(locks);
      CHECK(drawn.bytes() == bytes);

      drawn.attributes().follow(selects);
      const Seen selected = see(drawn, ColorSource::rgb, raster);
      // A lock stays visible below a selection, and the selection above a lock.
      std::vector<std::uint8_t> weights(cloud.size(), 255);
      drawn.attributes().showLock(weights);
      const Seen both = see(drawn, ColorSource::rgb, raster);
      drawn.attributes().showLock({});
      CHECK(brightness(both.left()) < 0.7 * brightness(selected.left()));
      CHECK(both.left().x > 2.5 * both.left().z);
      CHECK(both.right().x < 1.5 * both.right().z);
      CHECK(glm::distance(both.left(), both.right()) > 0.2);
      CHECK(isColor(selected.left(), tinted(own)));
      CHECK(isColor(selected.right(), own));
      CHECK(selected.depth.depth == before.depth.depth);

      drawn.attributes().follow(hides);
      const Seen hidden = see(drawn, ColorSource::rgb, raster);
      CHECK_FALSE(hidden.isCovered(kSide_px / 2 - 12));
      CHECK(hidden.isCovered(kSide_px / 2 + 12));
      CHECK(isColor(hidden.right(), own));

      drawn.attributes().follow(hides);
      CHECK(see(drawn, ColorSource::rgb, raster).color.rgba == selected.color.rgba);
      drawn.attributes().follow(selects);
      CHECK(see(drawn, ColorSource::rgb, raster).color.rgba == before.color.rgba);
      CHECK(drawn.attributes().mask(MaskRole::selected) == nullptr);
    }
  }
}

TEST_CASE_FIXTURE(
    AttributesFixture,
    "numbers are drawn in the colours of each map, follow their changes, and are grey where there are none") {
  const PointCloud cloud = planeCloud(true);
  const PointSet left = leftOf(cloud);
  std::vector<float> numbers;
  std::vector<std::pair<std::uint64_t, float>> warmer;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    numbers.push_back(left.test(i) ? 280.0f : std::nanf(""));
    if (left.test(i)) warmer.emplace_back(i, 320.0f);
  }
  warmer.emplace_back(1'000'000, 1.0f);  // beyond the drawn points
  for (const Raster raster : rasters())
    for (const auto& [name, map] : kColorMaps) {
      CAPTURE(static_cast<int>(raster));
      CAPTURE(name);
      map_ = map;
      const auto expected = [&](float number) {
        return DVec3(shared::numberColor(static_cast<std::uint32_t>(map), number, 260, 340));
      };
      FieldColors colors{.low = 260, .high = 340};
      DrawnCloud drawn(device, cloud);
      const Seen own = see(drawn, colors, raster);  // no numbers are shown
      CHECK(isColor(own.left(), encoded(kGreen)));
      drawn.attributes().show(numbers);
      const Seen seen = see(drawn, colors, raster);
      CHECK(isColor(seen.left(), expected(280)));
      CHECK(isColor(seen.right(), DVec3(shared::kNoNumberColor)));
      CHECK(see(drawn, ColorSource::rgb, raster).color.rgba == own.color.rgba);
      drawn.attributes().set(warmer);
      CHECK(isColor(see(drawn, colors, raster).left(), expected(320)));
      const std::vector<AttributeChange> selects{MaskFlip{.points = left}};
      drawn.attributes().follow(selects);
      CHECK(isColor(see(drawn, colors, raster).left(), tinted(expected(320))));
      drawn.attributes().follow(selects);
      colors = {.low = 400, .high = 400};  // below an empty range
      if (map != ColorMap::classes)
        CHECK(isColor(see(drawn, colors, raster).left(), DVec3(shared::rampColor(static_cast<std::uint32_t>(map), 0))));
      drawn.attributes().showNone();
      CHECK(see(drawn, colors, raster).color.rgba == own.color.rgba);
    }
}

TEST_CASE("ramps begin and end with the colours of their maps, and standard classes are told apart") {
  const auto at = [](std::uint32_t map, float x) { return DVec3(shared::rampColor(map, x)) * 255.0; };
  const auto is = [](const DVec3& seen, const DVec3& expected) { return glm::distance(seen, expected) < 1; };
  CHECK(is(at(shared::kMapViridis, 0), {68, 1, 84}));
  CHECK(is(at(shared::kMapViridis, 0.5f), {33, 145, 140}));
  CHECK(is(at(shared::kMapViridis, 1), {253, 231, 37}));
  CHECK(is(at(shared::kMapTurbo, 1), {144, 13, 0}));
  CHECK(is(at(shared::kMapGrey, 0.5f), {134, 134, 134}));
  CHECK(is(at(shared::kMapRedBlue, 0), {178, 24, 43}));
  CHECK(is(at(shared::kMapRedBlue, 0.5f), {247, 247, 247}));
  CHECK(is(at(shared::kMapRedBlue, 1), {33, 102, 172}));
  CHECK(is(at(shared::kMapViridis, -3), at(shared::kMapViridis, 0)));
  for (int a = 0; a < 19; ++a)
    for (int b = 0; b < a; ++b)
      CHECK(glm::distance(shared::classColor(static_cast<float>(a)), shared::classColor(static_cast<float>(b))) > 0.1f);
}

TEST_CASE_FIXTURE(AttributesFixture, "points of masks and fields that the drawn cloud cannot hold are ignored") {
  const PointCloud cloud = planeCloud(false);
  DrawnCloud drawn(device, cloud);
  const Seen before = see(drawn);
  drawn.attributes().show(std::vector<float>(100));  // fewer than the cloud has
  const std::vector<AttributeChange> changes{
      MaskFlip{.role = MaskRole::hidden, .points = PointSet::range(1'000'000, 1'010'000)}};
  drawn.attributes().follow(changes);
  CHECK(see(drawn).color.rgba == before.color.rgba);
}

TEST_SUITE_END();

}  // namespace palpate::drawn_attributes_test
