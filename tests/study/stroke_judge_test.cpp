#include "engine/study/stroke_judge.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/cloud/edited_cloud.hpp"
#include "tests/near.hpp"

namespace palpate::test::stroke_judge_test {
namespace {

using Words = std::vector<std::string_view>;

constexpr int kSide = 40;

// A plate of two square grids, 1 apart: the upper one faces up at z = 0, the lower one down.
PointCloud plate(double thickness) {
  PointCloud cloud;
  for (const double side : {1.0, -1.0})
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        cloud.positions.emplace_back(x - kSide / 2, y - kSide / 2, side > 0 ? 0 : -thickness);
        cloud.normals.emplace_back(0, 0, side);
      }
  return cloud;
}

// A stroke of a ball of 6 mm on the middle of the upper side.
PlayedStroke strokeOf(BrushKind brush, double depth_mm) {
  return {.brush = brush,
          .radius_mm = 6,
          .depth_mm = depth_mm,
          .yield_mm = 0.5,
          .drag_mm = 0,
          .lift_mm = 4,
          .isOpen = true,
          .mm_per_unit = 1,
          .spots = {DVec3(0)},
          .normals = {DVec3(0, 0, 1)}};
}

struct Stroke {
  PointCloud cloud;
  std::vector<PointState> states;

  explicit Stroke(double thickness) : cloud(plate(thickness)), states(statesOf(cloud)) {}
  // Presses points of the upper side down by `depth` in the middle, by nothing 6 mm away.
  void press(double depth) {
    for (PointState& state : states)
      if (const double r = std::hypot(state.position.x, state.position.y); state.normal.z > 0 && r < 6)
        state.position.z -= static_cast<float>(depth * (1 - r * r / 36) * (1 - r * r / 36));
  }
  // The points of the upper side nearer to the middle than this.
  template <class Change>
  std::size_t within(double radius, const Change& change) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < kSide * kSide; ++i)
      if (std::hypot(states[i].position.x, states[i].position.y) < radius) change(states[i]), ++count;
    return count;
  }
  StrokeVerdict verdict(BrushKind brush = BrushKind::push, double depth_mm = 2) const {
    return StrokeJudge(cloud).judge(states, strokeOf(brush, depth_mm));
  }
};

}  // namespace

TEST_CASE("a dent is whole, also where it leaves less of a plate than the points are apart") {
  for (const double left : {8.5, 0.5, 0.25}) {
    CAPTURE(left);
    Stroke stroke(1.5 + left);
    stroke.press(1.5);
    const StrokeVerdict verdict = stroke.verdict();
    CHECK(verdict.broken() == Words{});
    CHECK(verdict.turned == 0);
    CHECK(verdict.deepest_mm == near(1.5, 1e-6));
  }
}

TEST_CASE("normals that face against their own side are counted, whatever side is near") {
  for (const double thickness : {10.0, 1.75}) {
    CAPTURE(thickness);
    Stroke stroke(thickness);
    stroke.press(1.5);
    const std::size_t turned = stroke.within(3.5, [](PointState& state) { state.normal = -state.normal; });
    const StrokeVerdict verdict = stroke.verdict();
    CHECK(verdict.turned == turned);
    CHECK(verdict.turns);
  }
}

TEST_CASE("a normal that is nearly at a right angle to the carried one has not turned") {
  for (const float cosine : {-0.15f, -0.25f}) {
    CAPTURE(cosine);
    Stroke stroke(10);
    stroke.press(0.01);
    const std::size_t leaning =
        stroke.within(3.5, [&](PointState& state) { state.normal = Vec3(std::sqrt(1 - cosine * cosine), 0, cosine); });
    CHECK(stroke.verdict().turned == (cosine < -0.2f ? leaning : 0));
  }
}

TEST_CASE("a new point takes its side from the old ones around it") {
  for (const float facing : {1.0f, -1.0f}) {
    CAPTURE(facing);
    Stroke stroke(10);
    stroke.press(1.5);
    const std::size_t added = 8;
    for (std::size_t k = 0; k < added; ++k)
      stroke.states.push_back({.position = Vec3(-3.5f + static_cast<float>(k), 0.5f, -1.2f),
                               .number = static_cast<std::uint32_t>(stroke.states.size()),
                               .normal = Vec3(0, 0, facing),
                               .parent = kSide * kSide / 2 + kSide / 2});
    CHECK(stroke.verdict().turned == (facing > 0 ? 0 : added));
    CHECK(stroke.verdict().inserted == added);
  }
}

TEST_CASE("a new point has its side also where another part of the surface is folded under it, nearer than its own") {
  Stroke stroke(10);
  for (std::size_t i = 0; i < kSide * kSide; ++i) {
    PointState& state = stroke.states[i];
    if (state.position.x < 9) continue;
    state.position = {16.5f - state.position.x, state.position.y, -0.3f};
    state.normal = -state.normal;
  }
  stroke.states.push_back({.position = Vec3(5.5f, 0.5f, 0),
                           .number = static_cast<std::uint32_t>(stroke.states.size()),
                           .normal = Vec3(0, 0, 1),
                           .parent = kSide * kSide / 2 + kSide / 2 + 5});
  CHECK(stroke.verdict().turned == 0);
}

TEST_CASE("a push through the far side of a plate is over the surface, one deep inside of a solid is not") {
  for (const double thickness : {2.0, 30.0}) {
    CAPTURE(thickness);
    Stroke stroke(thickness);
    stroke.press(9.5);
    const StrokeVerdict verdict = stroke.verdict(BrushKind::push, 10);
    CHECK(verdict.raises == (thickness < 9.5));
    CHECK((verdict.through > 0) == (thickness < 9.5));
  }
}

TEST_CASE("a push that raises the surface, one that leaves flakes, and a far side that moves are broken") {
  Stroke raised(10), flakes(10), far(10);
  raised.press(-1);
  CHECK(raised.verdict().raises);
  flakes.press(1.5);
  flakes.within(4, [](PointState& state) { state.position.z -= state.number % 3 == 0 ? 3.0f : 0.0f; });
  CHECK(flakes.verdict().tears);
  far.press(1.5);
  for (std::size_t i = kSide * kSide; i < far.states.size(); ++i)
    if (std::hypot(far.states[i].position.x, far.states[i].position.y) < 3) far.states[i].position.z -= 1;
  CHECK(far.verdict().movesFar);
  CHECK(far.verdict().farMoved_mm == near(1, 1e-6));
}

TEST_CASE("the wall that carve leaves faces the tool, however its points came there") {
  for (const bool inwards : {true, false}) {
    CAPTURE(inwards);
    Stroke stroke(40);
    // A ball of 6 mm, its lowest point 7.5 mm deep: along the walls the order of the points shows nothing.
    const DVec3 center(0, 0, -1.5);
    const std::size_t carved = stroke.within(5.9, [&](PointState& state) {
      const double r = std::hypot(state.position.x, state.position.y);
      const DVec3 place(state.position.x, state.position.y, center.z - std::sqrt(36 - r * r));
      state.position = Vec3(place);
      state.normal = Vec3((inwards ? 1.0 : -1.0) * glm::normalize(center - place));
    });
    const StrokeVerdict verdict = stroke.verdict(BrushKind::carve, 8);
    CHECK(verdict.turned == (inwards ? 0 : carved));
  }
}

}  // namespace palpate::test::stroke_judge_test
