
#include <doctest/doctest.h>

#include "haptics/study/truth_path.hpp"
#include "tests/near.hpp"

namespace palpate::test::touch_truth_test {
namespace {

constexpr double kStep = 0.05;

}  // namespace

TEST_CASE("on a smooth shape the god-object is the closest point of the truth") {
  for (const char* name : {"plane", "sphere", "torus", "bumpy-sphere"}) {
    CAPTURE(name);
    const auto shape = makeShape(name);
    const TouchTruth truth = truthOf(*shape);
    const TruthPath slide =
        truthSlide(truth, shape->areaMap(1)({0.4, 0.6}), DVec3(1, 2, 3), {1}, {.speed_mm_per_s = 200});
    GodObject ideal(truth, kStep);
    for (double t_s = 0; t_s < slide.path.duration_s(); t_s += 1e-3) {
      const DVec3 hip = slide.path.at(t_s);
      ideal.follow(hip);
      CHECK(ideal.touching() == (shape->signedDistance(hip) <= 0));
      CHECK(glm::distance(ideal.contact().position, shape->closest(hip).position) < 1e-4);
      if (t_s < slide.from_s || t_s > slide.to_s) continue;
      CHECK(shape->signedDistance(hip) == near(-1, 1e-3));
    }
  }
}

TEST_CASE("over a cube's edge the god-object stays on its face, and is free beyond the edge") {
  const auto shape = makeShape("cube");
  const TouchTruth truth = truthOf(*shape);
  const TruthPath slide = truthSlide(truth, {{50, 45, 0}, {1, 0, 0}}, {0, 1, 0}, {1}, {.length_mm = 10});
  GodObject ideal(truth, kStep);
  std::size_t touched = 0;
  for (double t_s = 0; t_s < slide.to_s; t_s += 1e-3) {
    const DVec3 hip = slide.path.at(t_s);
    ideal.follow(hip);
    CHECK(ideal.touching() == (hip.x <= 50 && hip.y <= 50));
    if (!ideal.touching()) continue;
    ++touched;
    CHECK(glm::distance(ideal.contact().position, DVec3(50, hip.y, 0)) < 1e-6);
    CHECK(angleBetween_deg(ideal.contact().normal, {1, 0, 0}) < 1e-6);
  }
  CHECK(touched > 100);
  CHECK(slide.path.at(slide.to_s).y == near(55, 1e-6));
}

TEST_CASE("the god-object does not break through at any speed, nor touch from inside") {
  const auto shape = makeShape("torus");  // its tube is 30 mm thick
  const TouchTruth truth = truthOf(*shape);
  GodObject pushed(truth, kStep);
  pushed.follow({35, 0, 20});
  pushed.follow({35, 0, -20});
  CHECK(pushed.touching());
  CHECK(pushed.contact().position.z == near(15, 1e-6));
  GodObject inside(truth, kStep);
  inside.follow({35, 0, 0});
  inside.follow({35, 0, 5});
  CHECK_FALSE(inside.touching());
}

TEST_CASE("a press rests at its depth in its window, and taps start and end in the air") {
  const SurfacePoint spot{{0, 0, 0}, {0, 0, 1}};
  const ModelScale scale{10};
  const TruthPath press = truthPress(spot, scale, {.depth_mm = 2});
  CHECK(press.path.at(press.from_s).z == near(-0.2, 1e-6));
  CHECK(press.path.at(press.to_s).z == near(-0.2, 1e-6));
  CHECK(press.to_s - press.from_s == near(0.125, 1e-6));
  const TruthPath taps = truthTaps(spot, scale, {.speed_mm_per_s = 100});
  CHECK(taps.path.at(0).z == near(0.5, 1e-6));
  CHECK(taps.path.at(taps.to_s).z == near(0.5, 1e-6));
  CHECK(taps.to_s == near(5 * 2 * 6 / 100.0, 1e-6));
}

}  // namespace palpate::test::touch_truth_test
