// The shadow on the ground: the sky that columns hide, compared with sums in double precision, and where it is drawn.
#include "engine/render/ground.hpp"

#include <algorithm>
#include <cmath>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/gpu/transfer.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::ground_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr double kTurn = 6.283185307179586;

/// The points of a disc of radius 1 at a height.
void addDisc(PointCloud& cloud, double height, const DVec2& center = DVec2(0), double spacing = 0.01) {
  for (double x = -1; x <= 1; x += spacing)
    for (double z = -1; z <= 1; z += spacing)
      if (x * x + z * z <= 1) cloud.positions.emplace_back(center.x + x, height, center.y + z);
}
void addWall(PointCloud& cloud, double x, double height) {
  for (double y = 0; y <= height; y += 0.02)
    for (double z = -1; z <= 1; z += 0.02) cloud.positions.emplace_back(x, y, z);
}

class GroundFixture : public PictureFixture {
 protected:
  std::vector<float> shadowOf(Ground& ground, const DrawnCloud& cloud, const shared::GroundMap& map) {
    CommandList list(device, device.throughputQueue(), "ground");
    list.begin();
    ground.follow(list, cloud, map);
    list.end();
    device.throughputQueue().run(list);
    made_ = !list.passes().empty();
    return download<float>(device, device.throughputQueue(), ground.shadow(), std::size_t{map.cells} * map.cells);
  }
  std::vector<float> shadowOf(const PointCloud& cloud, const shared::GroundMap& map) {
    Ground ground(device);
    return shadowOf(ground, DrawnCloud(device, cloud), map);
  }
  bool made_ = false;  // by the last call
};

/// At the middle of a cell, in map coordinates.
double at(const std::vector<float>& shadow, const shared::GroundMap& map, const DVec3& place) {
  const DVec3 from = place - DVec3(map.corner);
  const auto column = static_cast<std::size_t>(glm::dot(from, DVec3(map.along)) / double{map.cell});
  const auto row = static_cast<std::size_t>(glm::dot(from, DVec3(map.across)) / double{map.cell});
  return double{shadow[row * map.cells + column]};
}

/// Share of the sky that the cells' columns hide, by many directions and small steps.
double hiddenAt(const std::vector<DVec2>& columns, const shared::GroundMap& map, int column, int row) {
  constexpr int kDirections = 256;
  double sum = 0;
  const int cells = static_cast<int>(map.cells);
  for (int k = 0; k < kDirections; ++k) {
    const double angle = kTurn * (k + 0.5) / kDirections;
    double low = 1, high = 0;
    for (double r = 0; r < 2 * cells; r += 0.25) {
      const double x = std::round(column + r * std::cos(angle)), y = std::round(row + r * std::sin(angle));
      if (x < 0 || y < 0 || x >= cells || y >= cells) break;
      const DVec2& heights = columns[static_cast<std::size_t>(y) * map.cells + static_cast<std::size_t>(x)];
      if (!(heights.x <= heights.y)) continue;
      const double away = std::max(r, 0.5) * double{map.cell};
      const auto squaredSine = [&](double height) { return height * height / (height * height + away * away); };
      low = std::min(low, squaredSine(heights.x));
      high = std::max(high, r < 0.5 ? 1 : squaredSine(heights.y));
    }
    sum += std::max(high - low, 0.0);
  }
  return sum / kDirections;
}

std::vector<DVec2> columnsOf(const PointCloud& cloud, const shared::GroundMap& map) {
  std::vector<DVec2> columns(std::size_t{map.cells} * map.cells, DVec2(1e300, -1e300));
  for (const Vec3& position : cloud.positions) {
    const DVec3 from = DVec3(position) - DVec3(map.corner);
    const double column = std::floor(glm::dot(from, DVec3(map.along)) / double{map.cell});
    const double row = std::floor(glm::dot(from, DVec3(map.across)) / double{map.cell});
    if (column < 0 || row < 0 || column >= map.cells || row >= map.cells) continue;
    DVec2& heights = columns[static_cast<std::size_t>(row) * map.cells + static_cast<std::size_t>(column)];
    const double height = std::max(glm::dot(from, DVec3(map.up)), 0.0);
    heights = {std::min(heights.x, height), std::max(heights.y, height)};
  }
  return columns;
}

Camera cameraAt(const DVec3& eye) {
  Camera camera;
  camera.eye = eye;
  camera.nearDepth = 0.1;
  return camera;
}

}  // namespace

TEST_CASE_FIXTURE(GroundFixture, "below the middle of a disc the sky is hidden by the square of the sine of its rim") {
  for (const double height : {0.5, 1.0, 2.0}) {
    CAPTURE(height);
    PointCloud cloud;
    addDisc(cloud, height);
    Bounds box = boundsOf(cloud);
    box.min.y = 0;
    const shared::GroundMap map = groundMap(box, {0, 1, 0}, 0.01);
    CHECK(at(shadowOf(cloud, map), map, DVec3(0.01, 0, 0.01)) == within(1 / (1 + height * height), 0.03));
  }
}

TEST_CASE_FIXTURE(GroundFixture, "the map is that of all directions, for each up axis and awkward numbers of cells") {
  PointCloud cloud;
  addWall(cloud, 0.6, 1.5);
  addDisc(cloud, 0.8, {-0.7, 0.3}, 0.02);
  for (const double spacing : {0.02, 0.05, 0.4, 10.0})
    for (const int axis : {0, 1, 2})
      for (const double sign : {1.0, -1.0}) {
        CAPTURE(spacing);
        CAPTURE(axis);
        CAPTURE(sign);
        DVec3 up(0);
        up[axis] = sign;
        const shared::GroundMap map = groundMap(boundsOf(cloud), up, spacing);
        CHECK(map.cells <= shared::kMaxGroundCells);
        const std::vector<float> shadow = shadowOf(cloud, map);
        const std::vector<DVec2> columns = columnsOf(cloud, map);
        double sum = 0;
        std::size_t count = 0;
        const std::size_t stride = std::max<std::size_t>(1, shadow.size() / 300);
        for (std::size_t i = 0; i < shadow.size(); i += stride, ++count) {
          CHECK(shadow[i] >= 0);
          CHECK(shadow[i] <= 1.0001f);
          const int column = static_cast<int>(i % map.cells), row = static_cast<int>(i / map.cells);
          double expected = 0, shares = 0;  // the blur over 5 x 5 cells
          for (int y = -2; y <= 2; ++y)
            for (int x = -2; x <= 2; ++x) {
              const int c = column + x, r = row + y;
              if (c < 0 || r < 0 || c >= static_cast<int>(map.cells) || r >= static_cast<int>(map.cells)) continue;
              const double share = (std::abs(x) == 2 ? 0.5 : 1) * (std::abs(y) == 2 ? 0.5 : 1);
              expected += share * hiddenAt(columns, map, c, r);
              shares += share;
            }
          sum += std::abs(double{shadow[i]} - expected / shares);
        }
        CHECK(sum / static_cast<double>(count) < (spacing < 0.1 ? 0.03 : 0.06));  // steps as long as a cell
      }
}

TEST_CASE_FIXTURE(GroundFixture, "the map is made again after an edit and a change of hidden points, and only then") {
  PointCloud cloud;
  addDisc(cloud, 1, DVec2(0), 0.05);
  const shared::GroundMap map = groundMap({.min = {-1, 0, -1}, .max = {1, 1, 1}}, {0, 1, 0}, 0.05);
  DrawnCloud drawn(device, cloud, {.edited = true});
  Ground ground(device);
  const std::vector<float> first = shadowOf(ground, drawn, map);
  CHECK(made_);
  CHECK(shadowOf(ground, drawn, map) == first);
  CHECK_FALSE(made_);

  const auto firstRight = std::ranges::find_if(cloud.positions, [](const Vec3& p) { return p.x >= 0; });
  const std::vector<AttributeChange> hides{
      MaskFlip{.role = MaskRole::hidden,
               .points = PointSet::range(0, static_cast<std::uint64_t>(firstRight - cloud.positions.begin()))}};
  drawn.attributes().follow(hides);
  const std::vector<float> half = shadowOf(ground, drawn, map);
  CHECK(made_);
  CHECK(at(half, map, {-0.9, 0, 0}) < 0.7 * at(first, map, {-0.9, 0, 0}));
  drawn.attributes().follow(hides);
  CHECK(shadowOf(ground, drawn, map) == first);

  for (Vec3& position : cloud.positions) position.y = 0.25f;
  drawn.catchUp(statesOf(cloud));
  const std::vector<float> lower = shadowOf(ground, drawn, map);
  CHECK(made_);
  CHECK(lower == shadowOf(cloud, map));
  CHECK(at(lower, map, {0, 0, 0}) > 1.2 * at(first, map, {0, 0, 0}));
}

TEST_CASE_FIXTURE(GroundFixture, "the shadow darkens the background below the model, and nothing else") {
  PointCloud cloud = sampleShape(*makeShape("sphere", 1.0), {.count = 4000});
  FrameOptions plain{.splatRadius = 0.05, .background = {{200, 200, 200}}};
  FrameOptions shaded = plain;
  shaded.light.ground = true;
  for (const std::uint32_t supersample : {1u, 2u}) {
    for (const auto& [eye, isAbove] : {std::pair(DVec3(0, 1.2, 3), true), std::pair(DVec3(0, -2.5, 3), false)}) {
      const Image before = picture(cloud, cameraAt(eye), plain, 97, 71, supersample);
      const Image after = picture(cloud, cameraAt(eye), shaded, 97, 71, supersample);
      std::size_t darker = 0, other = 0;
      for (std::size_t i = 0; i < before.rgba.size(); ++i) {
        if (before.rgba[i] == after.rgba[i]) continue;
        (after.rgba[i][1] < before.rgba[i][1] && before.rgba[i][0] == before.rgba[i][1] ? darker : other) += 1;
      }
      CHECK((darker > 300) == isAbove);
      CHECK((darker == 0) != isAbove);
      CHECK(other < 40);  // at the model's rim, where a pixel shows both
    }
  }
  const Image empty = picture({}, cameraAt({0, 1, 3}), shaded, 17, 3, 1);
  CHECK(empty.rgba == picture({}, cameraAt({0, 1, 3}), plain, 17, 3, 1).rgba);
}

TEST_SUITE_END();

}  // namespace palpate::ground_test
