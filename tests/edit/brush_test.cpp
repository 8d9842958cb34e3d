// The laws of the brushes: single precision in C++ and on the GPU against double, and what each brush promises.
#include "engine/edit/brush_reference.hpp"

#include <random>

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/shared/edit.h"
#include "shaders/test_shaders.hpp"
#include "tests/edit/brush_probe.h"
#include "tests/gpu_fixture.hpp"

namespace palpate {

namespace {

constexpr double kSupport = 1.5;

struct Question {
  BrushOptions options;
  shared::BrushQuestion asked;
};

// Points in and around the balls of every brush, from a tool far in the surface to one that does not touch it.
std::vector<Question> randomQuestions(std::size_t count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0, 1);
  const auto signedShare = [&] { return 2 * share(random) - 1; };
  const auto direction = [&] {
    DVec3 v(0);
    while (glm::length(v) < 0.1) v = {signedShare(), signedShare(), signedShare()};
    return glm::normalize(v);
  };
  std::vector<Question> questions;
  while (questions.size() < count) {
    BrushOptions options{.kind = kBrushKinds[questions.size() % kBrushKinds.size()].second,
                         .tau = 0.5 * share(random),
                         .beta = share(random),
                         .toolRadius = 1 + 9 * share(random),
                         .strength = share(random),
                         .falloff = static_cast<std::uint32_t>(5 * share(random))};
    for (auto& channel : options.color) channel = static_cast<std::uint8_t>(256 * share(random));
    const DVec3 hip = 40.0 * direction(), outward = direction();
    const DVec3 spring = 3 * share(random) * outward;
    const DVec3 position = hip + spring + 1.5 * options.toolRadius * share(random) * direction();
    questions.push_back({.options = options,
                         .asked = {.brush = sharedBrush(options, kSupport),
                                   .hip = Vec3(hip),
                                   .lastHip = Vec3(hip + share(random) * direction()),
                                   .spring = Vec3(spring),
                                   .touching = 1,
                                   .position = Vec3(position),
                                   .normal = Vec3(direction()),
                                   .color = static_cast<std::uint32_t>(random())}});
  }
  return questions;
}

// How far single precision may be from double: rounding at 50 units from the origin.
constexpr double kRounding = 5e-5;

// Every answer agrees with double precision; a point on the edge of a decision may fall on either side of it, which is
// counted.
void checkAgree(const std::vector<Question>& questions, const std::vector<shared::BrushAnswer>& answers,
                double signedDistance) {
  std::size_t otherSide = 0, moved = 0, taken = 0, colored = 0;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const auto& [options, q] = questions[i];
    const BrushTool tool(options, kSupport, DVec3(q.hip), DVec3(q.lastHip), DVec3(q.spring));
    const DVec3 place(q.position), normal(q.normal);
    const BrushTool::Point expected = tool.brushed(place, normal);
    moved += expected.position != place;
    taken += expected.taken;
    if (expected.taken != (answers[i].brushed.taken != 0)) {
      ++otherSide;
    } else {
      CHECK(glm::distance(DVec3(answers[i].brushed.position), expected.position) < kRounding);
    }
    const DVec3 smooth =
        tool.smoothed(place, {.defined = true, .distance = signedDistance, .normal = normal, .neighbours = 9});
    CHECK(glm::distance(DVec3(answers[i].smoothed), smooth) < kRounding);
    const auto is = unpackedColor(answers[i].painted), wanted = unpackedColor(tool.painted(place, q.color));
    colored += answers[i].painted != q.color;
    for (std::size_t k = 0; k < 4; ++k) CHECK(std::abs(is[k] - wanted[k]) <= 1);
  }
  CHECK(otherSide < 3);
  CHECK(moved > questions.size() / 8);
  CHECK(taken > questions.size() / 50);
  CHECK(colored > questions.size() / 20);
}

}  // namespace

TEST_CASE("single precision does what double does, with every brush") {
  const auto questions = randomQuestions(6000);
  for (const double signedDistance : {0.3, -2.0}) {
    std::vector<shared::BrushAnswer> answers;
    for (const Question& question : questions)
      answers.push_back(answerTo(question.asked, static_cast<float>(signedDistance)));
    checkAgree(questions, answers, signedDistance);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "the GPU does what double does, with every brush") {
  constexpr double kSignedDistance = 0.3;
  const auto questions = randomQuestions(6000);
  std::vector<shared::BrushQuestion> asked;
  for (const Question& question : questions) asked.push_back(question.asked);
  // One more than are asked: validation takes the last bytes of a struct for a multiple of 16.
  const Buffer input = Buffer::of<shared::BrushQuestion>(device, asked.size() + 1, Memory::device, "questions");
  const Buffer output = Buffer::of<shared::BrushAnswer>(device, asked.size() + 1, Memory::device, "answers");
  upload(device, input, asked);
  const ComputePipeline pipeline(device, shader_code::edit_brush_probe, {.pushBytes = sizeof(shared::BrushProbeArgs)});
  const auto count = static_cast<std::uint32_t>(asked.size());
  CommandList list(device, device.touch(), "brushes");
  list.begin();
  list.dispatch(pipeline, count,
                shared::BrushProbeArgs{.questions = input.address(),
                                       .answers = output.address(),
                                       .count = count,
                                       .signedDistance = static_cast<float>(kSignedDistance)});
  list.end();
  device.touch().run(list);
  checkAgree(questions, download<shared::BrushAnswer>(device, output, asked.size()), kSignedDistance);
}

TEST_CASE("no brush moves a point further than a quarter of a support radius, or acts on what is free or yields less") {
  const double longest = static_cast<double>(shared::kLongestMove) * kSupport;
  for (const auto& [name, kind] : kBrushKinds) {
    CAPTURE(name);
    const BrushOptions options{.kind = kind, .tau = 0.5, .beta = 1, .toolRadius = 1e4, .strength = 1, .falloff = 0};
    const DVec3 hip(0, 0, -2), lastHip(5, 0, -2), place(3, 1, 0), normal(0, 0, 1);
    const BrushTool tool(options, kSupport, hip, lastHip, {0, 0, 2});
    CHECK(tool.acts());
    CHECK(glm::distance(tool.brushed(place, normal).position, place) <= longest * (1 + 1e-12));
    const SurfaceSample far{.defined = true, .distance = 100, .normal = normal, .neighbours = 9};
    CHECK(glm::distance(tool.smoothed(place, far), place) <= longest * (1 + 1e-12));
    const BrushTool shallow(options, kSupport, hip, lastHip, {0, 0, 0.5});
    CHECK_FALSE(shallow.acts());
    CHECK(shallow.brushed(place, normal).position == place);
    CHECK(shallow.smoothed(place, far) == place);
    CHECK(shallow.painted(place, 7) == 7);
    CHECK(toolOf(sharedBrush(options, kSupport), Vec3(hip), Vec3(lastHip), Vec3(0, 0, 2), 0).acts == 0);
  }
}

TEST_CASE("each brush does at the middle of the tool what its strength says") {
  const DVec3 hip(0, 0, -1), lastHip(0.1, 0, -1), spring(0, 0, 1), middle(0), up(0, 0, 1);
  const auto at = [&](BrushKind kind) {
    const BrushOptions options{.kind = kind, .tau = 0.1, .toolRadius = 4, .strength = 0.5};
    return BrushTool(options, kSupport, hip, lastHip, spring);
  };
  CHECK(glm::distance(at(BrushKind::inflate).brushed(middle, up).position, DVec3(0, 0, 0.002)) < 1e-9);
  CHECK(glm::distance(at(BrushKind::grab).brushed(middle, up).position, DVec3(-0.05, 0, 0)) < 1e-12);
  const SurfaceSample below{.defined = true, .distance = 0.2, .normal = up, .neighbours = 9};
  CHECK(glm::distance(at(BrushKind::smooth).smoothed(middle, below), DVec3(0, 0, -0.1)) < 1e-12);
  CHECK(at(BrushKind::smooth).smoothed(middle, {}) == middle);
  // The ball of carve reaches 0.9 below the surface: what faces it goes half of that way, what faces away is gone.
  const BrushTool::Point cut = at(BrushKind::carve).brushed(middle, up);
  CHECK_FALSE(cut.taken);
  CHECK(cut.position.z == doctest::Approx(-0.375));  // the longest move
  CHECK(at(BrushKind::carve).brushed(middle, -up).taken);
  CHECK(at(BrushKind::carve).brushed(DVec3(0, 0, 3.1), up).taken);  // as deep as no surface is that it has met slowly
}

TEST_CASE("paint arrives at its colour and stays there, however weak it is") {
  const BrushOptions options{
      .kind = BrushKind::paint, .tau = 0, .toolRadius = 4, .strength = 0.001, .color = {10, 200, 0, 255}};
  const BrushTool tool(options, kSupport, {0, 0, -1}, {0, 0, -1}, {0, 0, 1});
  std::uint32_t color = packedColor({255, 0, 130, 0});
  for (int tick = 0; tick < 256; ++tick) color = tool.painted({3.9, 0, 0}, color);
  CHECK(color == packedColor(options.color));
  CHECK(tool.painted({0, 0, 0}, color) == color);
  CHECK(tool.painted({4.1, 0, 0}, 5) == 5);
}

}  // namespace palpate
