// Masks of points: hidden ones are not felt, locked ones not changed, in a program's session.
#include <algorithm>
#include <cmath>

#include "tests/library/ball.hpp"
#include "tests/near.hpp"

namespace palpate::masks_test {

namespace {

// Those of the ball's points that lie above a height.
std::vector<std::uint8_t> above(double height, std::uint64_t count) {
  const BallArrays<double> ball(count);
  std::vector<std::uint8_t> mask(count);
  for (std::size_t i = 0; i < count; ++i) mask[i] = ball.positions[3 * i + 2] > height ? 1 : 0;
  return mask;
}

double largestForce(pp_session session, double depth_mm) {
  double most_N = 0;
  const auto path = pressPath(depth_mm);
  for (const pp_tick& tick : touch(session, pathOf(path))) most_N = std::max(most_N, lengthOf(tick.force_N));
  return most_N;
}

}  // namespace

TEST_CASE("a program hides points, which no hand feels then, shows them, and undoes both") {
  constexpr std::uint64_t kCount = 20'000;
  const OpenBall ball(cpuOptions(), kCount);
  const std::vector<std::uint8_t> top = above(0, kCount), none(kCount);
  CHECK(largestForce(ball.session, 1) > 0.5);
  PP_REQUIRE_OK(pp_session_set_mask(ball.session, PP_MASK_HIDDEN, top.data(), kCount));
  CHECK(largestForce(ball.session, 1) == 0);
  CHECK(placesOf(ball.session).size() == 3 * kCount);
  std::vector<std::uint8_t> mask(kCount, 7);
  PP_REQUIRE_OK(pp_session_mask(ball.session, PP_MASK_HIDDEN, mask.data(), kCount));
  CHECK(mask == top);
  PP_REQUIRE_OK(pp_session_mask(ball.session, PP_MASK_LOCKED, mask.data(), kCount));
  CHECK(mask == none);
  std::uint64_t done = 0;
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, &done));
  CHECK(done == 1);
  CHECK(largestForce(ball.session, 1) > 0.5);
  PP_REQUIRE_OK(pp_session_redo(ball.session, 1, &done));
  CHECK(largestForce(ball.session, 1) == 0);
  PP_REQUIRE_OK(pp_session_set_mask(ball.session, PP_MASK_HIDDEN, none.data(), kCount));
  CHECK(largestForce(ball.session, 1) > 0.5);
}

TEST_CASE("a brush changes no locked point, and a stroke keeps the masks that were set before the first brush") {
  constexpr std::uint64_t kCount = 20'000;
  const OpenBall ball(cpuOptions(), kCount);
  const std::vector<std::uint8_t> all(kCount, 1);
  PP_REQUIRE_OK(pp_session_set_mask(ball.session, PP_MASK_LOCKED, all.data(), kCount));
  const std::vector<double> before = placesOf(ball.session);
  const auto path = pressPath(3);
  pp_brush brush = pp_default_brush();
  stroke(ball.session, pathOf(path), brush);
  CHECK(placesOf(ball.session) == before);
  const std::vector<std::uint8_t> low = above(-200, kCount);  // all of them: within
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, nullptr));
  PP_REQUIRE_OK(pp_session_set_mask(ball.session, PP_MASK_WITHIN, low.data(), kCount));
  stroke(ball.session, pathOf(path), brush);
  CHECK(placesOf(ball.session) != before);
}

TEST_CASE("a program locks points in part, softens the rim, and undoes each to the bit") {
  constexpr std::uint64_t kCount = 20'000;
  const OpenBall ball(cpuOptions(), kCount);
  const std::vector<double> before = placesOf(ball.session);
  const auto path = pressPath(3);
  const pp_brush brush = pp_default_brush();
  const auto deepest = [&] {  // of a stroke, which is undone
    stroke(ball.session, pathOf(path), brush);
    const std::vector<double> after = placesOf(ball.session);
    PP_REQUIRE_OK(pp_session_undo(ball.session, 1, nullptr));
    CHECK(placesOf(ball.session) == before);
    double most = 0;
    for (std::size_t i = 0; i < before.size(); ++i) most = std::max(most, std::abs(after[i] - before[i]));
    return most;
  };
  const double whole = deepest();
  CHECK(whole > 1);
  std::vector<std::uint8_t> weights(kCount, 51), read(kCount);
  PP_REQUIRE_OK(pp_session_set_mask(ball.session, PP_MASK_LOCK_WEIGHTS, weights.data(), kCount));
  PP_REQUIRE_OK(pp_session_mask(ball.session, PP_MASK_LOCK_WEIGHTS, read.data(), kCount));
  CHECK(read == weights);
  CHECK(deepest() / whole == within(0.8, 0.05));
  const std::vector<std::uint8_t> top = above(0, kCount);
  PP_REQUIRE_OK(pp_session_set_mask(ball.session, PP_MASK_LOCKED, top.data(), kCount));
  PP_REQUIRE_OK(pp_session_mask(ball.session, PP_MASK_LOCKED, read.data(), kCount));
  CHECK(read == top);
  PP_REQUIRE_OK(pp_session_soften_lock(ball.session, 10));
  PP_REQUIRE_OK(pp_session_mask(ball.session, PP_MASK_LOCK_WEIGHTS, read.data(), kCount));
  const BallArrays<double> arrays(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    const double height = arrays.positions[3 * i + 2];
    if (std::abs(height) > 10.5) CHECK(read[i] == (height > 0 ? 255 : 0));
    if (height > 0) CHECK(read[i] == 255);  // what is locked wholly stays so
    if (height < 0 && height > -0.5) CHECK(int{read[i]} == within(127, 25));
  }
  std::uint64_t done = 0;
  PP_REQUIRE_OK(pp_session_undo(ball.session, 3, &done));
  CHECK(done == 3);
  PP_REQUIRE_OK(pp_session_mask(ball.session, PP_MASK_LOCK_WEIGHTS, read.data(), kCount));
  CHECK(read == std::vector<std::uint8_t>(kCount));
  CHECK(pp_session_soften_lock(ball.session, 0) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("radius_mm"));
}

TEST_CASE("a program removes and moves points of a mask, all others stay, and undo restores them to the bit") {
  constexpr std::uint64_t kCount = 20'000;
  const OpenBall ball(cpuOptions(), kCount);
  const std::vector<double> before = placesOf(ball.session);
  const std::vector<std::uint8_t> top = above(20, kCount);
  const double quarter[]{std::sqrt(0.5), 0, 0, std::sqrt(0.5)}, offset[]{100, 0, 1};
  PP_REQUIRE_OK(pp_session_move_points(ball.session, top.data(), kCount, quarter, 2, offset));
  const std::vector<double> moved = placesOf(ball.session);
  std::size_t wrong = 0, count = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double* const p = &before[3 * i];
    const double* const q = &moved[3 * i];
    count += top[i];
    wrong += top[i] ? std::abs(q[0] - 100 + 2 * p[1]) + std::abs(q[1] - 2 * p[0]) + std::abs(q[2] - 1 - 2 * p[2]) > 1e-4
                    : !std::equal(p, p + 3, q);
  }
  CHECK(wrong == 0);
  CHECK(count > 1'000);
  CHECK(largestForce(ball.session, 1) == 0);  // nothing is there any more
  std::uint64_t done = 0;
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, &done));
  CHECK(placesOf(ball.session) == before);
  PP_REQUIRE_OK(pp_session_move_points(ball.session, top.data(), kCount, nullptr, 1, nullptr));
  CHECK(placesOf(ball.session) == before);
  PP_REQUIRE_OK(pp_session_remove_points(ball.session, top.data(), kCount));
  CHECK(placesOf(ball.session).size() == 3 * (kCount - count));
  CHECK(largestForce(ball.session, 1) == 0);
  PP_CHECK_FAILS(pp_session_remove_points(ball.session, top.data(), kCount), PP_ERROR_ARGUMENT, "values were given");
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, &done));
  CHECK(placesOf(ball.session) == before);
  PP_CHECK_FAILS(pp_session_move_points(ball.session, top.data(), kCount, nullptr, 0, nullptr), PP_ERROR_ARGUMENT,
                 "positive");
  PP_CHECK_FAILS(pp_session_move_points(ball.session, top.data(), kCount, offset, 1, nullptr), PP_ERROR_ARGUMENT,
                 "unit");
  CHECK(placesOf(ball.session) == before);
}

TEST_CASE("masks of another length, unknown masks, and the first one of a live session are refused") {
  const OpenBall ball(cpuOptions(), 2'000);
  const std::vector<std::uint8_t> mask(2'001);
  PP_CHECK_FAILS(pp_session_set_mask(ball.session, PP_MASK_HIDDEN, mask.data(), 2'001), PP_ERROR_ARGUMENT,
                 "2001 values were given, but there are 2000 points");
  PP_CHECK_FAILS(pp_session_set_mask(ball.session, PP_MASK_HIDDEN, nullptr, 2'000), PP_ERROR_ARGUMENT, "mask: is null");
  PP_CHECK_FAILS(pp_session_set_mask(ball.session, static_cast<pp_mask>(5), mask.data(), 2'000), PP_ERROR_ARGUMENT,
                 "is not a pp_mask");
  const OpenBall other(cpuOptions(), 2'000);
  pp_live_options live = pp_default_live_options();
  live.builtin = "press";
  PP_REQUIRE_OK(pp_live_start(other.session, &live));
  PP_CHECK_FAILS(pp_session_set_mask(other.session, PP_MASK_HIDDEN, mask.data(), 2'000), PP_ERROR_STATE,
                 "before the session is live");
  PP_REQUIRE_OK(pp_live_stop(other.session));
}

}  // namespace palpate::masks_test
