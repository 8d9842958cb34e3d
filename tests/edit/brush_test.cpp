// The laws of the brushes: single precision in C++ compared with double, and each brush's promises.
#include "engine/edit/placed_brush.hpp"

#include <random>

#include "shaders/shared/edit.h"
#include "tests/edit/brush_questions.hpp"
#include "tests/near.hpp"

namespace palpate::brush_test {

TEST_CASE("every brush in single precision agrees with double precision") {
  const auto questions = randomQuestions(6000);
  for (const double signedDistance : {0.3, -2.0}) {
    std::vector<shared::BrushAnswer> answers;
    for (const BrushCase& question : questions)
      answers.push_back(answerTo(question.asked, static_cast<float>(signedDistance)));
    checkAgree(questions, answers, signedDistance);
  }
}

TEST_CASE(
    "brushes move points at most a quarter of a support radius, and act on no point that is free or yields less") {
  const double longest = static_cast<double>(shared::kLongestMove) * kSupport;
  for (const auto& [name, kind] : kBrushKinds) {
    CAPTURE(name);
    const BrushOptions options{
        .kind = kind, .yieldDepth = 0.5, .pushRate = 1, .radius = 1e4, .strength = 1, .falloff = 0};
    const DVec3 hip(0, 0, -2), lastHip(5, 0, -2), place(3, 1, 0), normal(0, 0, 1);
    const PlacedBrush::Found found{place, normal, double{shared::kUnseen}};
    const PlacedBrush brush = brushAt(options, kSupport, hip, {0, 0, 2}, hip - lastHip);
    CHECK(brush.acts());
    CHECK(glm::distance(brush.brushed(place, normal, found).position, place) <= longest * (1 + 1e-12));
    const SurfaceSample far{.defined = true, .distance = 100, .normal = normal, .neighbours = 9};
    CHECK(glm::distance(brush.smoothed(place, found, far), place) <= longest * (1 + 1e-12));
    const PlacedBrush shallow = brushAt(options, kSupport, hip, {0, 0, 0.5});
    CHECK_FALSE(shallow.acts());
    CHECK(shallow.brushed(place, normal, found).position == place);
    CHECK(shallow.smoothed(place, found, far) == place);
    CHECK(shallow.painted(place, found, 7) == 7);
  }
}

TEST_CASE("a brush changes no point that it says is out of its reach") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(-1, 1);
  const auto somewhere = [&](double far) { return far * DVec3{share(random), share(random), share(random)}; };
  for (const auto& [name, kind] : kBrushKinds) {
    CAPTURE(name);
    std::size_t reached = 0, skipped = 0, wrong = 0;
    for (const double depth : {1.0, 3.0, 9.0}) {  // the last one with a shaft
      const BrushOptions options{.kind = kind, .yieldDepth = 0.5, .pushRate = 1, .radius = 2, .strength = 1};
      const PlacedBrush brush = brushAt(options, kSupport, {0, 0, -depth}, {0, 0, depth}, {0.3, 0, 0});
      for (int i = 0; i < 20'000; ++i) {
        const DVec3 place = brush.center() + somewhere(brush.radius()), normal = glm::normalize(somewhere(1));
        const PlacedBrush::Found found{place + somewhere(0.5), normal, double{shared::kUnseen}};
        const SurfaceSample surface{.defined = true, .distance = 1, .normal = normal, .neighbours = 9};
        const PlacedBrush::Point after = brush.brushed(place, normal, found);
        const bool changes = after.position != place || after.taken || brush.painted(place, found, 7) != 7 ||
                             (brush.has(shared::kUsesNeighbours) && brush.smoothed(place, found, surface) != place);
        const bool mayAffect = brush.mayAffect(place);
        reached += changes;
        skipped += !mayAffect;
        wrong += changes && !mayAffect;
      }
    }
    CHECK(wrong == 0);
    CHECK(reached > 100);
    if (!brushHas(kind, shared::kMeasuresFound)) CHECK(skipped > 10'000);
  }
}

TEST_CASE("each brush has its nominal effect at its centre") {
  const DVec3 hip(0, 0, -1), spring(0, 0, 1), middle(0), up(0, 0, 1);
  const auto at = [&](BrushKind kind, const DVec3& place, const DVec3& normal) {
    const BrushOptions options{.kind = kind, .yieldDepth = 0.1, .pushRate = 0.2, .radius = 4, .strength = 0.5};
    const DVec3 motion = kind == BrushKind::grab ? DVec3(-0.1, 0, 0) : DVec3(0);
    return brushAt(options, kSupport, hip, spring, motion)
        .brushed(place, normal, {place, normal, double{shared::kUnseen}});
  };
  const DVec3 taken(0.1, 0, 0);  // where grab began
  CHECK(glm::distance(at(BrushKind::inflate, middle, up).position, DVec3(0, 0, 0.002)) < 1e-9);
  CHECK(glm::distance(at(BrushKind::grab, taken, up).position, taken - DVec3(0.05, 0, 0)) < 1e-12);
  // Onto the plane of the surface from either side, and not along it.
  CHECK(glm::distance(at(BrushKind::flatten, {0, 0, 0.3}, up).position, DVec3(0, 0, 0.15)) < 2e-3);
  CHECK(glm::distance(at(BrushKind::flatten, {0, 0, -0.3}, up).position, DVec3(0, 0, -0.15)) < 2e-3);
  CHECK(at(BrushKind::flatten, {1, 2, 0}, up).position == DVec3(1, 2, 0));
  const SurfaceSample below{.defined = true, .distance = 0.2, .normal = up, .neighbours = 9};
  const BrushOptions smooths{.kind = BrushKind::smooth, .yieldDepth = 0.1, .radius = 4, .strength = 0.5};
  const PlacedBrush smooth = brushAt(smooths, kSupport, hip, spring);
  CHECK(glm::distance(smooth.smoothed(middle, {middle, up, double{shared::kUnseen}}, below), DVec3(0, 0, -0.1)) <
        1e-12);
  CHECK(smooth.smoothed(middle, {middle, up, double{shared::kUnseen}}, {}) == middle);
  // The ball reaches 0.9 below the surface: push moves a point by its fraction of the distance down, anywhere above the
  // ball.
  CHECK(glm::distance(at(BrushKind::push, middle, up).position, DVec3(0, 0, -0.18)) < 1e-12);
  const double chord = std::sqrt(16 - 4);
  CHECK(glm::distance(at(BrushKind::push, {2, 0, 0}, up).position, DVec3(2, 0, -0.2 * (chord - 3.1))) < 1e-12);
  // Carving moves a point that faces the ball half of the way to its wall, and removes one that faces away.
  const PlacedBrush::Point cut = at(BrushKind::carve, middle, up);
  CHECK_FALSE(cut.taken);
  CHECK(cut.position.z == near(-0.375, 1e-6));  // the longest move
  CHECK(at(BrushKind::carve, middle, -up).taken);
  CHECK(at(BrushKind::carve, {0, 0, 3.1}, up).taken);  // too deep for a surface that it met slowly
}

TEST_CASE("every brush except carve and grab leaves a side of the model that faces away unchanged") {
  const DVec3 hip(0, 0, -1), spring(0, 0, 1), far(0.2, 0.1, -0.4), down(0, 0, -1);
  for (const auto& [name, kind] : kBrushKinds) {
    if (kind == BrushKind::carve) continue;
    CAPTURE(name);
    const BrushOptions options{.kind = kind, .yieldDepth = 0.1, .pushRate = 1, .radius = 4, .strength = 1};
    const DVec3 motion = kind == BrushKind::grab ? DVec3(0.3, 0, 0) : DVec3(0);
    const PlacedBrush brush = brushAt(options, kSupport, hip, spring, motion);
    CHECK(brush.acts());
    const DVec3 moved = brush.brushed(far, down, {far, down, double{shared::kUnseen}}).position - far;
    if (kind == BrushKind::grab)
      CHECK(moved.x > 0.1);
    else
      CHECK(moved == DVec3(0));
    CHECK(brush.smoothed(far, {far, down, double{shared::kUnseen}},
                         {.defined = true, .distance = 0.3, .normal = down}) == far);
    CHECK(brush.painted(far, {far, down, double{shared::kUnseen}}, 7) == 7);
  }
}

TEST_CASE("points that face away move less, slide along their surface, and do not accumulate motion over many edits") {
  const BrushOptions options{.kind = BrushKind::push, .yieldDepth = 0.1, .pushRate = 1, .radius = 4};
  const PlacedBrush brush = brushAt(options, 1000, {0, 0, -1}, {0, 0, 1});  // its full intended distance in one edit
  const DVec3 began(0, 0, 0);
  const auto pressed = [&](double cosine, int edits) {
    const DVec3 normal(std::sqrt(1 - cosine * cosine), 0, cosine);
    DVec3 place = began;
    for (int k = 0; k < edits; ++k)
      place = brush.brushed(place, normal, {began, normal, double{shared::kUnseen}}).position;
    if (cosine < 0) CHECK(glm::dot(place - began, normal) == within(0, 1e-6));  // not out of the solid
    return -place.z;
  };
  for (const int edits : {1, 30}) CHECK(pressed(1, edits) == near(0.9, 1e-9));
  CHECK(pressed(0, 1) == near(0.9, 1e-9));
  CHECK(pressed(-0.3, 1) == near(0.9 * (1 - 0.3 * 0.3), 1e-6));
  CHECK(pressed(-0.3, 30) == near(0.9, 0.02));
  CHECK(pressed(-0.55, 1) == near(0.45 * (1 - 0.55 * 0.55), 1e-6));
  CHECK(pressed(-0.55, 30) == near(0.45, 0.02));
  CHECK(pressed(-0.8, 30) == within(0, 1e-6));
}

TEST_CASE("paint converges to its colour and stays there, however weak it is") {
  const BrushOptions options{
      .kind = BrushKind::paint, .yieldDepth = 0, .radius = 4, .strength = 0.001, .color = {10, 200, 0, 255}};
  const PlacedBrush brush = brushAt(options, kSupport, {0, 0, -1}, {0, 0, 1});
  const PlacedBrush::Found facing{DVec3(0), DVec3(0, 0, 1)};
  std::uint32_t color = packedColor({255, 0, 130, 0});
  for (int tick = 0; tick < 256; ++tick) color = brush.painted({3.9, 0, 0}, facing, color);
  CHECK(color == packedColor(options.color));
  CHECK(brush.painted({0, 0, 0}, facing, color) == color);
  CHECK(brush.painted({4.1, 0, 0}, facing, 5) == 5);
}

}  // namespace palpate::brush_test
