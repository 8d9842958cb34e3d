// Sculpting through the C interface: what a stroke changes, what it leaves, and undo.
#include <algorithm>
#include <cmath>
#include <set>

#include "tests/library/ball.hpp"
#include "tests/near.hpp"

namespace palpate::strokes_test {

namespace {

pp_brush pushOf(double radius_mm) {
  pp_brush brush = pp_default_brush();
  brush.radius_mm = radius_mm;
  return brush;
}

using Place = std::array<double, 3>;
std::multiset<Place> setOf(const std::vector<double>& places) {
  std::multiset<Place> set;
  for (std::size_t i = 0; i < places.size(); i += 3) set.insert({places[i], places[i + 1], places[i + 2]});
  return set;
}

}  // namespace

TEST_CASE("a stroke dents the ball along its path and nowhere else, and undo restores every bit") {
  const OpenBall ball;
  const auto before = placesOf(ball.session);
  const auto path = pressPath(4, 150, 50);
  const auto ticks = stroke(ball.session, pathOf(path), pushOf(5));
  CHECK(ticks.size() == 200);
  const auto after = placesOf(ball.session);
  CHECK(after != before);
  double lowest = 1e9, farthest = 0;
  const auto was = setOf(before);
  for (std::size_t i = 0; i < after.size(); i += 3) {
    if (was.contains({after[i], after[i + 1], after[i + 2]})) continue;
    lowest = std::min(lowest, after[i + 2]);
    farthest = std::max(farthest, std::hypot(after[i] - 0.3, after[i + 1] + 0.2));
  }
  CHECK(lowest < kBallRadius - 2);
  CHECK(farthest < 5 + 2);  // the brush, and the support radius around it
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(ball.session, &info));
  CHECK(info.undo_count == 1);
  CHECK(info.redo_count == 0);
  CHECK(info.edits > 100);
  CHECK(info.blocked_moves + info.blocked_edits == 0);

  std::uint64_t done = 0;
  PP_REQUIRE_OK(pp_session_undo(ball.session, 5, &done));
  CHECK(done == 1);
  CHECK(placesOf(ball.session) == before);
  PP_REQUIRE_OK(pp_session_redo(ball.session, 1, &done));
  CHECK(done == 1);
  CHECK(setOf(placesOf(ball.session)) == setOf(after));
  PP_REQUIRE_OK(pp_session_redo(ball.session, 1, &done));
  CHECK(done == 0);
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, nullptr));
}

TEST_CASE("the state of a session says that a part is too thin for its brush") {
  std::vector<float> positions, normals;
  for (int side = 0; side < 2; ++side)
    for (int i = -40; i <= 40; ++i)
      for (int k = -40; k <= 40; ++k) {
        const auto top = static_cast<float>(kBallRadius);
        positions.insert(positions.end(), {0.5f * float(i), 0.5f * float(k), side == 0 ? top : top - 0.4f});
        normals.insert(normals.end(), {0, 0, side == 0 ? 1.0f : -1.0f});
      }
  pp_cloud_arrays arrays = pp_default_cloud_arrays();
  arrays.count = positions.size() / 3;
  arrays.positions = {positions.data(), PP_FLOAT32, 0, 0};
  arrays.normals = {normals.data(), PP_FLOAT32, 0, 0};
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
  pp_session session{};
  const pp_session_options options = cpuOptions();
  PP_REQUIRE_OK(pp_session_open(cloud, &options, &session));
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(session, &info));
  CHECK(info.blocked_moves + info.blocked_edits == 0);
  const auto path = pressPath(2, 50, 100);
  stroke(session, pathOf(path), pushOf(5));
  PP_REQUIRE_OK(pp_session_get_info(session, &info));
  CHECK(info.blocked_edits > 80);
  CHECK(info.blocked_moves > 50 * info.blocked_edits);
  PP_REQUIRE_OK(pp_session_close(session));
  PP_REQUIRE_OK(pp_cloud_close(cloud));
}

TEST_CASE("touching without a brush changes nothing, and a dent is felt") {
  const OpenBall ball;
  const auto path = pressPath(1);
  const auto untouched = placesOf(ball.session);
  const double first_N = touch(ball.session, pathOf(path)).back().force_N[2];
  CHECK(placesOf(ball.session) == untouched);
  const auto deep = pressPath(4, 150, 100);
  stroke(ball.session, pathOf(deep), pushOf(5));
  const auto dented = placesOf(ball.session);
  const auto ticks = touch(ball.session, pathOf(path));
  CHECK(ticks.back().force_N[2] < 0.5 * first_N);  // the surface is lower there
  CHECK(placesOf(ball.session) == dented);
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, nullptr));
  CHECK(touch(ball.session, pathOf(path)).back().force_N[2] == near(first_N, 1e-6));
}

TEST_CASE("a session's brush sculpts tick by tick, but not where the pose says to feel only") {
  const OpenBall ball;
  const auto path = pressPath(4, 150, 20);
  const pp_brush brush = pushOf(5);
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
  const auto before = placesOf(ball.session);
  for (const std::uint32_t noEdit : {1u, 0u}) {
    PP_REQUIRE_OK(pp_touch_lift(ball.session));
    for (std::size_t i = 0; i < path.size() / 3; ++i) {
      const pp_pose pose{.t_s = 1e-3 * static_cast<double>(i),
                         .hip = {path[3 * i], path[3 * i + 1], path[3 * i + 2]},
                         .no_edit = noEdit};
      pp_contact contact{};
      PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
    }
    CHECK((placesOf(ball.session) != before) == (noEdit == 0));
  }
  // A path only feels, even with a brush, and the brush stays set.
  const auto dented = placesOf(ball.session);
  touch(ball.session, pathOf(path));
  CHECK(placesOf(ball.session) == dented);
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, nullptr));
  std::uint64_t done = 0;
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, &done));
  CHECK(done == 1);
  CHECK(placesOf(ball.session) == before);
}

TEST_CASE("only brushes that keep the density add or remove points, in either order of strokes") {
  checkDensityIsOfTheBrush(cpuOptions());
}

TEST_CASE("each parameter of a brush takes effect with its own stroke, whatever brush was used before") {
  constexpr std::size_t kPoints = 5'000;
  const auto path = pressPath(5, 60, 10);
  const pp_brush usual = pushOf(8);
  const OpenBall used(cpuOptions(), kPoints);
  const auto strokeOn = [&](pp_session session, const pp_brush& brush) {
    stroke(session, pathOf(path), brush);
    const auto places = placesOf(session);
    PP_REQUIRE_OK(pp_session_undo(session, 1, nullptr));
    return setOf(places);
  };
  const auto before = strokeOn(used.session, usual);
  const auto checkTakesEffect = [&](auto&& change) {
    pp_brush brush = usual;
    change(brush);
    const OpenBall fresh(cpuOptions(), kPoints);
    const auto after = strokeOn(used.session, brush);
    CHECK(after != before);
    CHECK(after == strokeOn(fresh.session, brush));
  };
  checkTakesEffect([](pp_brush& b) { b.radius_mm = 6; });
  checkTakesEffect([](pp_brush& b) { b.yield_depth_mm = 1; });
  checkTakesEffect([](pp_brush& b) { b.resample = 0; });
  checkTakesEffect([](pp_brush& b) {
    b.kind = "inflate";
    b.strength = 0.1;
  });
}

TEST_CASE("carving removes points, painting gives them colours") {
  const OpenBall ball;
  const auto path = pressPath(4, 150, 50);
  pp_brush brush = pushOf(5);
  brush.kind = "carve";
  stroke(ball.session, pathOf(path), brush);
  pp_cloud carved{};
  PP_REQUIRE_OK(pp_session_cloud(ball.session, &carved));
  pp_points points{};
  PP_REQUIRE_OK(pp_cloud_view(carved, &points));
  const auto places = setOf(placesOf(ball.session));
  std::size_t above = 0;
  for (const Place& p : places) above += std::hypot(p[0] - 0.3, p[1] + 0.2) < 2 && p[2] > kBallRadius - 1;
  CHECK(above == 0);
  PP_CHECK_OK(pp_cloud_close(carved));
  brush.kind = "paint";
  brush.color[0] = 10;
  brush.color[1] = 200;
  brush.color[2] = 30;
  brush.strength = 1;
  const auto deeper = pressPath(6, 150, 50);
  stroke(ball.session, pathOf(deeper), brush);
  pp_cloud painted{};
  PP_REQUIRE_OK(pp_session_cloud(ball.session, &painted));
  PP_REQUIRE_OK(pp_cloud_view(painted, &points));
  REQUIRE(points.colors);
  std::size_t green = 0;
  for (std::size_t i = 0; i < points.count; ++i) green += points.colors[4 * i + 1] > 190 && points.colors[4 * i] < 60;
  CHECK(green > 10);
  CHECK(green < 2'000);
  PP_CHECK_OK(pp_cloud_close(painted));
  brush.kind = "scrub";
  PP_CHECK_FAILS(pp_session_set_brush(ball.session, &brush), PP_ERROR_ARGUMENT, "push, carve");
  brush.kind = nullptr;
  brush.radius_mm = -1;
  PP_CHECK_FAILS(pp_session_set_brush(ball.session, &brush), PP_ERROR_ARGUMENT, "radius_mm");
}

TEST_CASE("an answer that an edit would delay beyond the budget is held, and says how old it is") {
  pp_session_options options = cpuOptions();
  options.budget_us = 1;
  const OpenBall ball(options, 100'000);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 12;
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
  double fresh_s = 0, applied_s = -1, last_N = 0;
  int held = 0, wrong = 0;
  for (int i = 0; i < 400; ++i) {
    const pp_pose pose{.t_s = 1e-3 * i, .hip = {0.3, -0.2, 52 - 0.015 * i}};
    pp_contact contact{};
    PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
    wrong += contact.valid == 0;
    if (contact.fresh || contact.age_s == 0) fresh_s = pose.t_s;  // also bridged from the points as they are
    // A slow machine may hold an answer of the points that pp_session_apply_edits() has left.
    if (std::abs(contact.age_s - (pose.t_s - applied_s)) < 1e-12) fresh_s = std::max(fresh_s, applied_s);
    held += contact.fresh == 0;
    CHECK(contact.age_s == within(pose.t_s - fresh_s, 1e-12));
    const double force_N = lengthOf(contact.force_N);
    // Points from before an edit count less and less from 20 to 40 ms after it.
    if (contact.age_s > 0.04) CHECK(force_N <= std::max(0.0, last_N - 0.06) + 1e-9);
    last_N = force_N;
    if (i % 30 == 0) {
      PP_REQUIRE_OK(pp_session_apply_edits(ball.session));
      applied_s = pose.t_s;
    }
  }
  CHECK(wrong == 0);
  CHECK(held > 20);
}

}  // namespace palpate::strokes_test
