// Several clouds in the space of one session: felt, edited and read back as one.
#include <algorithm>
#include <limits>
#include <numbers>

#include "tests/library/ball.hpp"
#include "tests/near.hpp"

namespace palpate::placed_clouds_test {

namespace {

// A quarter turn about x: z of the cloud becomes -y of the session.
constexpr double kHalf = std::numbers::sqrt2 / 2;
constexpr double kTurn[4]{kHalf, kHalf, 0, 0};
constexpr double kOffset[3]{200, 10, -5};

pp_placed_cloud placed(pp_cloud cloud, bool moved) {
  pp_placed_cloud given{};
  given.cloud = cloud;
  if (!moved) return given;
  std::copy_n(kTurn, 4, given.orientation);
  std::copy_n(kOffset, 3, given.position);
  return given;
}

std::array<double, 3> inSession(const double* p) { return {kOffset[0] + p[0], kOffset[1] - p[2], kOffset[2] + p[1]}; }

struct TwoBalls {
  BallCloud one, other;
  pp_session session{};
  explicit TwoBalls(const pp_session_options& options = cpuOptions()) : one(20'000), other(20'000) {
    const std::array<pp_placed_cloud, 2> clouds{placed(one.cloud, false), placed(other.cloud, true)};
    PP_REQUIRE_OK(pp_session_open_clouds(clouds.data(), clouds.size(), &options, &session));
  }
  ~TwoBalls() { pp_session_close(session); }
  TwoBalls(const TwoBalls&) = delete;
  TwoBalls& operator=(const TwoBalls&) = delete;
};

std::vector<double> moved(const std::vector<double>& path) {
  std::vector<double> there;
  for (std::size_t i = 0; i < path.size(); i += 3) {
    const auto place = inSession(&path[i]);
    there.insert(there.end(), place.begin(), place.end());
  }
  return there;
}

}  // namespace

TEST_CASE("a hand feels each of two placed balls as it feels that ball alone, in its pose") {
  const TwoBalls two;
  const OpenBall alone;
  const auto path = pressPath(1.5);
  const pp_tick expected = touch(alone.session, pathOf(path)).back();
  const pp_tick first = touch(two.session, pathOf(path)).back();
  const pp_tick second = touch(two.session, pathOf(moved(path))).back();
  CHECK(first.contact == 1);
  CHECK(second.contact == 1);
  const auto proxy = inSession(expected.proxy);
  for (int k = 0; k < 3; ++k) {
    CHECK(first.proxy[k] == within(expected.proxy[k], 1e-4));
    CHECK(second.proxy[k] == within(proxy[static_cast<std::size_t>(k)], 1e-4));
  }
  CHECK(second.force_N[1] == within(-expected.force_N[2], 1e-3));
  CHECK(lengthOf(first.force_N) == near(lengthOf(expected.force_N), 1e-3));
}

TEST_CASE("a stroke on one of two clouds changes rows of that cloud alone, which read back in its own frame") {
  const TwoBalls two;
  std::vector<double> before = placesOf(two.session);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 8;
  brush.resample = 0;
  stroke(two.session, pathOf(moved(pressPath(4))), brush);
  const std::vector<double> after = placesOf(two.session);
  std::vector<pp_row> rows(40'000);
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_session_rows(two.session, rows.data(), rows.size(), &count));
  REQUIRE(count == 40'000);
  const BallArrays<float> arrays(20'000);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    CHECK(rows[i].cloud == i / 20'000);
    CHECK(rows[i].row == i % 20'000);
    if (!rows[i].changed) {
      CHECK(std::equal(&after[3 * i], &after[3 * i] + 3, &before[3 * i]));
      continue;
    }
    ++changed;
    CHECK(rows[i].cloud == 1);
    // Back in the cloud's own frame the point lies under the pole, near where it was.
    const double z = kOffset[1] - after[3 * i + 1];
    CHECK(z < static_cast<double>(arrays.positions[3 * rows[i].row + 2]));
    CHECK(z > 40);
  }
  CHECK(changed > 50);
}

TEST_CASE("queries say which cloud they met") {
  const TwoBalls two;
  const std::vector<double> from{0, 0, 90, 200, -90, -5}, along{0, 0, -1, 0, 1, 0};
  const pp_rows origins{from.data(), PP_FLOAT64, 0, 0}, directions{along.data(), PP_FLOAT64, 0, 0};
  std::vector<pp_surface_point> found(2);
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  PP_REQUIRE_OK(pp_session_raycast(two.session, &origins, &directions, 2, kEndless, found.data()));
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(found[i].found == 1);
    CHECK(found[i].cloud == i);
    CHECK(found[i].row < 30);  // the ball's rows begin at its pole
  }
  CHECK(found[1].position[1] == within(-40, 0.2));
}

TEST_CASE("a cloud without normals among others gets its own, and colours of one become clay for the rest") {
  const BallArrays<float> arrays(5'000);
  pp_cloud_arrays bare = arrays.arrays();
  bare.normals = {};
  const std::vector<std::uint8_t> red(15'000, 90);
  bare.colors = {red.data(), PP_UINT8, 0, 0};
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&bare, &cloud));
  const BallCloud whole(5'000);
  const std::array<pp_placed_cloud, 2> clouds{placed(whole.cloud, false), placed(cloud, true)};
  const pp_session_options options = cpuOptions();
  pp_session session{};
  PP_REQUIRE_OK(pp_session_open_clouds(clouds.data(), 2, &options, &session));
  CHECK(touch(session, pathOf(moved(pressPath(1.5)))).back().force_N[1] < -0.5);
  pp_cloud now{};
  PP_REQUIRE_OK(pp_session_cloud(session, &now));
  pp_points points{};
  PP_REQUIRE_OK(pp_cloud_view(now, &points));
  REQUIRE(points.colors);
  CHECK(points.colors[0] == 200);
  CHECK(points.colors[4 * 9'999] == 90);
  PP_CHECK_OK(pp_cloud_close(now));
  PP_CHECK_OK(pp_cloud_close(cloud));
  PP_CHECK_OK(pp_session_close(session));
}

TEST_CASE("clouds with an impossible pose are refused by their index") {
  const BallCloud ball(100);
  const pp_session_options options = cpuOptions();
  pp_session session{};
  std::array<pp_placed_cloud, 2> clouds{placed(ball.cloud, false), placed(ball.cloud, true)};
  clouds[1].orientation[0] = 3;
  PP_CHECK_FAILS(pp_session_open_clouds(clouds.data(), 2, &options, &session), PP_ERROR_ARGUMENT,
                 "clouds: 1: its orientation");
  clouds[1] = placed(ball.cloud, true);
  clouds[1].position[2] = std::numeric_limits<double>::infinity();
  PP_CHECK_FAILS(pp_session_open_clouds(clouds.data(), 2, &options, &session), PP_ERROR_ARGUMENT,
                 "clouds: 1: its position");
  clouds[1].cloud = {};
  CHECK(pp_session_open_clouds(clouds.data(), 2, &options, &session) == PP_ERROR_HANDLE);
  CHECK(pp_session_open_clouds(clouds.data(), 0, &options, &session) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_open_clouds(nullptr, 1, &options, &session) == PP_ERROR_ARGUMENT);
  CHECK(session.id == 0);
}

}  // namespace palpate::placed_clouds_test
