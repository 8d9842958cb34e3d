// Several hands on one cloud, each with a tool of its own, on each back end: each is answered as if it were alone.
#include <algorithm>
#include <array>

#include "engine/core/error.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/back_end.hpp"
#include "tests/touch/tick.hpp"

namespace palpate::hands_test {

namespace {

constexpr double kFriction = 0.3;
const BrushOptions kPush{.yieldDepth = 0.3, .pushRate = 0.5, .radius = 8};

struct OnHands : OnPlainBackEnd {
  std::unique_ptr<TouchBackend> make(const Scene& scene, const std::vector<ToolShape>& tools,
                                     const std::optional<BrushOptions>& brush = {}) const {
    return OnBackEnd::make(
        scene.cloud, {.radius = scene.radius, .friction = kFriction, .tools = tools, .brush = brush, .threads = 2});
  }
};

bool equal(const Contact& a, const Contact& b) {
  return a.valid && b.valid && a.fresh && b.fresh && a.proxy == b.proxy && a.normal == b.normal &&
         a.touching == b.touching && a.neighbours == b.neighbours;
}

bool equal(std::span<const PointContact> a, std::span<const PointContact> b) {
  return std::ranges::equal(a, b, [](const PointContact& left, const PointContact& right) {
    return left.hip == right.hip && left.share == right.share && equal(left.contact, right.contact);
  });
}

/// Each hand at its own position, all at the same height over the plane.
std::vector<Pose> overPlane(std::size_t hands, double z) {
  std::vector<Pose> poses(hands);
  for (std::size_t i = 0; i < hands; ++i) poses[i].hip = {i % 2 ? 6.0 : -6.0, i < 2 ? 6.1 : -6.1, z};
  return poses;
}

/// Hands that wander over shapes, each on its own path.
struct Wandering {
  const char* name;
  std::vector<ToolShape> tools;
  std::vector<std::string_view> shapes;
  std::size_t points, ticks;
  std::size_t touches;  // each hand touches at more ticks than these
};

std::vector<Wandering> wanderings() {
  const ToolShape pad = makeTool(ToolKind::pad, 6, 8), ball = makeTool(ToolKind::ball, 5, 6);
  const std::size_t ticks = byTier<std::size_t>(45, 120);
  return {{"two hands", {{}, {}}, {"sphere", "bumpy-sphere", "cube"}, 10'000, 150, 30},
          {"a tool of many points belongs to the first hand", {pad, {}}, {"bumpy-sphere"}, 10'000, 80, 10},
          {"four hands with any tool", {{}, pad, {}, ball}, {"bumpy-sphere", "cube"}, 5'000, ticks, ticks / 12}};
}

}  // namespace

TEST_CASE_FIXTURE(OnHands, "each of several hands is answered as if alone, bit by bit, with any tool" * kMoreInFull) {
  for (const Wandering& row : wanderings())
    for (const std::string_view shape : row.shapes) {
      CAPTURE(row.name);
      CAPTURE(shape);
      const Scene scene = makeScene(shape, row.points);
      const std::size_t hands = row.tools.size();
      const auto together = make(scene, row.tools);
      REQUIRE(together->hands() == hands);
      std::vector<std::unique_ptr<TouchBackend>> alone;
      std::vector<std::vector<DVec3>> ways;
      for (std::size_t i = 0; i < hands; ++i) {
        alone.push_back(make(scene, {row.tools[i]}));
        ways.push_back(wanderingPath(scene, row.ticks, 0.5 * scene.radius, static_cast<std::uint32_t>(2 + 7 * i)));
      }
      std::vector<std::size_t> touched(hands), different(hands);
      for (std::size_t tick = 0; tick < row.ticks; ++tick) {
        std::vector<Pose> poses;
        for (const auto& way : ways) poses.push_back({.time_s = kTick_s * static_cast<double>(tick), .hip = way[tick]});
        const auto answers = together->query(poses, 0);
        REQUIRE(answers.size() == hands);
        for (std::size_t i = 0; i < hands; ++i) {
          const Contact own = alone[i]->query(poses[i], 0);
          touched[i] += own.touching;
          different[i] += !equal(answers[i], own) || !equal(together->points(i), alone[i]->points(0));
        }
      }
      for (std::size_t i = 0; i < hands; ++i) {
        CAPTURE(i);
        CHECK(together->points(i).size() == row.tools[i].points.size());
        CHECK(touched[i] > row.touches);
        CHECK(different[i] == 0);
      }
    }
}

TEST_CASE_FIXTURE(OnHands, "the second hand feels the edits of the first, with the answer of the next tick") {
  const Scene scene = makeScene("sphere", 20'000);
  const auto touch = make(scene, std::vector<ToolShape>(2), kPush),
             alone = make(scene, std::vector<ToolShape>(1), kPush);
  // The second hand rests 6 deep at the pole; the first one descends close to it.
  const auto restingAt = [](int i) { return DVec3(0.6, 0, std::max(44.0, 52 - 0.5 * i)); };
  double atRest = 0, afterEdit = 0, last = 0;
  bool same = true;
  for (int i = 0; i < 120; ++i) {
    const double time_s = kTick_s * i;
    const DVec3 hip(0, 0, 52 - 4.5 * std::clamp((i - 40) / 50.0, 0.0, 1.0));
    const auto answers =
        touch->query(std::array{Pose{.time_s = time_s, .hip = hip}, Pose{.time_s = time_s, .hip = restingAt(i)}}, 0);
    same = same && equal(answers[0], alone->query({.time_s = time_s, .hip = hip}, 0));
    REQUIRE(answers[1].valid);
    REQUIRE(answers[1].touching == (i > 4));
    last = answers[1].proxy.z;
    const auto edited_s = touch->report().firstEdit_s;
    if (i >= 35 && (!edited_s || *edited_s == time_s)) atRest = last;
    if (edited_s && std::abs(time_s - *edited_s - kTick_s) < 1e-9) afterEdit = last;
  }
  touch->finish();
  alone->finish();
  CHECK(same);  // the first hand feels and does the same as without the second
  CHECK(atRest == near(50, 0.002));
  CHECK(afterEdit < atRest - 1e-4);
  CHECK(last < atRest - 1);
  CHECK(last > 44);
  PointCloud left = scene.cloud, right = scene.cloud;
  CHECK(touch->readBack(left) > 30);
  alone->readBack(right);
  CHECK(left.positions == right.positions);
}

TEST_CASE_FIXTURE(OnHands, "one of several hands is put down elsewhere, and the others continue") {
  const Scene scene = makeScene("plane", 10'000);
  for (const std::size_t hands : {2, 4})
    for (std::size_t lifted = 0; lifted < hands; ++lifted) {
      CAPTURE(hands);
      CAPTURE(lifted);
      const auto touch = make(scene, std::vector<ToolShape>(hands));
      const auto at = [&](double z) { return touch->query(overPlane(hands, z), 0); };
      std::span<const Contact> answers;
      for (double z = 4; z > -2; z -= 0.25) answers = at(z);
      for (const Contact& contact : answers) CHECK(contact.touching);
      touch->resetHand(lifted);
      answers = at(-2);
      // Put down inside the surface, it is not caught until it has been outside.
      for (std::size_t i = 0; i < hands; ++i) CHECK(answers[i].touching == (i != lifted));
      at(4);
      answers = at(-1);
      for (const Contact& contact : answers) CHECK(contact.touching);
    }
}

TEST_CASE_FIXTURE(OnHands, "a position of one hand that is not finite is a fault for all, at that pose only") {
  const Scene scene = makeScene("plane", 5'000);
  for (const std::size_t hands : {2, 4})
    for (std::size_t bad = 0; bad < hands; ++bad) {
      CAPTURE(hands);
      CAPTURE(bad);
      const auto touch = make(scene, std::vector<ToolShape>(hands));
      for (const double y : {std::nan(""), 1e300}) {
        std::vector<Pose> poses = overPlane(hands, 3);
        poses[bad].hip.y = y;
        for (const Contact& contact : touch->query(poses, 0)) {
          CHECK_FALSE(contact.valid);
          CHECK_FALSE(contact.lost);
        }
      }
      std::span<const Contact> answers;
      for (double z = 3; z > -1; z -= 0.25) answers = touch->query(overPlane(hands, z), 0);
      for (const Contact& contact : answers) {
        CHECK(contact.touching);
        CHECK(contact.normal.z == near(1, 1e-5));
      }
    }
}

TEST_CASE_FIXTURE(OnHands, "the number of hands is at least one and at most a maximum") {
  const Scene scene = makeScene("plane", 1'000);
  CHECK(make(scene, std::vector<ToolShape>(kMaxHands))->hands() == kMaxHands);
  for (const std::size_t hands : {std::size_t{0}, kMaxHands + 1})
    CHECK_THROWS_WITH_AS(make(scene, std::vector<ToolShape>(hands)), doctest::Contains("must be 1 to 8"), UsageError);
}

}  // namespace palpate::hands_test
