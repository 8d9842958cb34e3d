// Inputs for the laws of the brushes, and double-precision checks of the answers.
#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <random>
#include <vector>

#include "engine/edit/placed_brush.hpp"
#include "shaders/shared/edit.h"
#include "tests/edit/tool_at.hpp"
#include "tests/edit_gpu/brush_probe.h"
#include "tests/near.hpp"

namespace palpate {

inline constexpr double kSupport = 1.5;

struct BrushCase {
  BrushOptions options;
  BrushStroke::Tool tool;
  shared::BrushQuestion asked;
};

// Points in and around the balls of every brush, from a brush deep in the surface to one that does not touch it.
inline std::vector<BrushCase> randomQuestions(std::size_t count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0, 1);
  const auto signedShare = [&] { return 2 * share(random) - 1; };
  const auto direction = [&] {
    DVec3 v(0);
    while (glm::length(v) < 0.1) v = {signedShare(), signedShare(), signedShare()};
    return glm::normalize(v);
  };
  std::vector<BrushCase> questions;
  while (questions.size() < count) {
    BrushOptions options{.kind = kBrushKinds[questions.size() % kBrushKinds.size()].second,
                         .yieldDepth = 0.5 * share(random),
                         .pushRate = share(random),
                         .radius = 1 + 9 * share(random),
                         .strength = share(random),
                         .falloff = static_cast<std::uint32_t>(5 * share(random))};
    for (auto& channel : options.color) channel = static_cast<std::uint8_t>(256 * share(random));
    const DVec3 hip = 40.0 * direction(), outward = direction();
    const DVec3 spring = 3 * share(random) * outward;
    const DVec3 position = hip + spring + 1.5 * options.radius * share(random) * direction();
    const BrushStroke::Tool tool = toolAt(options, kSupport, hip, spring, share(random) * direction());
    questions.push_back({.options = options,
                         .tool = tool,
                         .asked = {.brush = sharedBrush(options, kSupport),
                                   .tool = sharedTool(tool),
                                   .position = Vec3(position),
                                   .normal = Vec3(direction()),
                                   .foundPosition = Vec3(position + share(random) * direction()),
                                   .foundNormal = Vec3(direction()),
                                   .room = static_cast<float>(1.5 * share(random)),
                                   .lock = questions.size() % 2 == 0 ? 0 : static_cast<float>(share(random)),
                                   .color = static_cast<std::uint32_t>(random())}});
  }
  return questions;
}

// Allowed difference between single and double precision: rounding at 50 units from the origin.
inline constexpr double kRounding = 5e-5;

// Every answer agrees with double precision. A point at the threshold of a decision may be on either side, which is
// counted.
inline void checkAgree(const std::vector<BrushCase>& questions, const std::vector<shared::BrushAnswer>& answers,
                       double signedDistance) {
  std::size_t otherSide = 0, moved = 0, taken = 0, colored = 0, says = 0, seen = 0;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const auto& [options, tool, q] = questions[i];
    const PlacedBrush brush(options, kSupport, tool);
    const DVec3 place(q.position), normal(q.normal);
    const PlacedBrush::Found found{DVec3(q.foundPosition), DVec3(q.foundNormal), double{q.room}, double{q.lock}};
    const PlacedBrush::Point expected = brush.brushed(place, normal, found);
    moved += expected.position != place;
    taken += expected.taken;
    if (expected.taken != (answers[i].brushed.taken != 0)) {
      ++otherSide;
    } else {
      CHECK(glm::distance(DVec3(answers[i].brushed.position), expected.position) < kRounding);
    }
    const DVec3 smooth =
        brush.smoothed(place, found, {.defined = true, .distance = signedDistance, .normal = normal, .neighbours = 9});
    CHECK(glm::distance(DVec3(answers[i].smoothed), smooth) < kRounding);
    const auto is = unpackedColor(answers[i].painted), wanted = unpackedColor(brush.painted(place, found, q.color));
    colored += answers[i].painted != q.color;
    for (std::size_t k = 0; k < 4; ++k) CHECK(std::abs(is[k] - wanted[k]) <= 1);
    const shared::MeasuredPoint measured = brush.measured(found), said = answers[i].measured;
    says += measured.weight > 0;
    const DVec3 offset = place - found.position;
    const auto inDouble = brushOf(options, kSupport);
    const auto path = shared::pathOf(inDouble, tool, found.position, found, 0.5);
    const double free = shared::freeUntil(inDouble, tool, path, {offset, normal, q.color % 2 != 0}, 1.0);
    const double beside = shared::freeBeside(inDouble, path, offset, -place, found.normal, 50.0);
    CHECK(answers[i].beside == within(beside, 1e-3));
    seen += free < 1;
    if (std::abs(answers[i].free - free) > 1e-3) ++otherSide;
    CHECK(std::abs(said.weight - measured.weight) <= 1);
    CHECK(std::abs(said.height - measured.height) <= 1400);  // one step of the weight or of the height
    for (int k = 0; k < 3; ++k) CHECK(std::abs(said.normal[k] - measured.normal[k]) <= 600);
  }
  CHECK(otherSide < 3);
  CHECK(moved > questions.size() / 8);
  CHECK(taken > questions.size() / 50);
  CHECK(colored > questions.size() / 20);
  CHECK(says > questions.size() / 10);
  CHECK(seen > questions.size() / 10);
}

}  // namespace palpate
