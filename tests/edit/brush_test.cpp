// The laws of the brushes: single precision in C++ against double, and what each brush promises.
#include "engine/edit/placed_brush.hpp"

#include "shaders/shared/edit.h"
#include "tests/edit/brush_questions.hpp"
#include "tests/near.hpp"

namespace palpate::brush_test {

TEST_CASE("single precision does what double does, with every brush") {
  const auto questions = randomQuestions(6000);
  for (const double signedDistance : {0.3, -2.0}) {
    std::vector<shared::BrushAnswer> answers;
    for (const BrushCase& question : questions)
      answers.push_back(answerTo(question.asked, static_cast<float>(signedDistance)));
    checkAgree(questions, answers, signedDistance);
  }
}

TEST_CASE("no brush moves a point further than a quarter of a support radius, or acts on what is free or yields less") {
  const double longest = static_cast<double>(shared::kLongestMove) * kSupport;
  for (const auto& [name, kind] : kBrushKinds) {
    CAPTURE(name);
    const BrushOptions options{.kind = kind, .tau = 0.5, .beta = 1, .radius = 1e4, .strength = 1, .falloff = 0};
    const DVec3 hip(0, 0, -2), lastHip(5, 0, -2), place(3, 1, 0), normal(0, 0, 1);
    const PlacedBrush brush(options, kSupport, hip, lastHip, {0, 0, 2});
    CHECK(brush.acts());
    CHECK(glm::distance(brush.brushed(place, normal).position, place) <= longest * (1 + 1e-12));
    const SurfaceSample far{.defined = true, .distance = 100, .normal = normal, .neighbours = 9};
    CHECK(glm::distance(brush.smoothed(place, far), place) <= longest * (1 + 1e-12));
    const PlacedBrush shallow(options, kSupport, hip, lastHip, {0, 0, 0.5});
    CHECK_FALSE(shallow.acts());
    CHECK(shallow.brushed(place, normal).position == place);
    CHECK(shallow.smoothed(place, far) == place);
    CHECK(shallow.painted(place, 7) == 7);
    CHECK(ballOf(sharedBrush(options, kSupport), Vec3(hip), Vec3(lastHip), Vec3(0, 0, 2), 0).acts == 0);
  }
}

TEST_CASE("each brush does at the middle of the brush what its strength says") {
  const DVec3 hip(0, 0, -1), lastHip(0.1, 0, -1), spring(0, 0, 1), middle(0), up(0, 0, 1);
  const auto at = [&](BrushKind kind) {
    const BrushOptions options{.kind = kind, .tau = 0.1, .radius = 4, .strength = 0.5};
    return PlacedBrush(options, kSupport, hip, lastHip, spring);
  };
  CHECK(glm::distance(at(BrushKind::inflate).brushed(middle, up).position, DVec3(0, 0, 0.002)) < 1e-9);
  CHECK(glm::distance(at(BrushKind::grab).brushed(middle, up).position, DVec3(-0.05, 0, 0)) < 1e-12);
  // Onto the plane through the proxy, from either side of it, and not along it.
  CHECK(glm::distance(at(BrushKind::flatten).brushed(DVec3(0, 0, 0.3), up).position, DVec3(0, 0, 0.15)) < 2e-3);
  CHECK(glm::distance(at(BrushKind::flatten).brushed(DVec3(0, 0, -0.3), up).position, DVec3(0, 0, -0.15)) < 2e-3);
  CHECK(at(BrushKind::flatten).brushed(DVec3(1, 2, 0), up).position == DVec3(1, 2, 0));
  const SurfaceSample below{.defined = true, .distance = 0.2, .normal = up, .neighbours = 9};
  CHECK(glm::distance(at(BrushKind::smooth).smoothed(middle, below), DVec3(0, 0, -0.1)) < 1e-12);
  CHECK(at(BrushKind::smooth).smoothed(middle, {}) == middle);
  // The ball of carve reaches 0.9 below the surface: what faces it goes half of that way, what faces away is gone.
  const PlacedBrush::Point cut = at(BrushKind::carve).brushed(middle, up);
  CHECK_FALSE(cut.taken);
  CHECK(cut.position.z == near(-0.375, 1e-6));  // the longest move
  CHECK(at(BrushKind::carve).brushed(middle, -up).taken);
  CHECK(at(BrushKind::carve).brushed(DVec3(0, 0, 3.1), up).taken);  // as deep as no surface is that it has met slowly
}

TEST_CASE("paint arrives at its colour and stays there, however weak it is") {
  const BrushOptions options{
      .kind = BrushKind::paint, .tau = 0, .radius = 4, .strength = 0.001, .color = {10, 200, 0, 255}};
  const PlacedBrush brush(options, kSupport, {0, 0, -1}, {0, 0, -1}, {0, 0, 1});
  std::uint32_t color = packedColor({255, 0, 130, 0});
  for (int tick = 0; tick < 256; ++tick) color = brush.painted({3.9, 0, 0}, color);
  CHECK(color == packedColor(options.color));
  CHECK(brush.painted({0, 0, 0}, color) == color);
  CHECK(brush.painted({4.1, 0, 0}, 5) == 5);
}

}  // namespace palpate::brush_test
