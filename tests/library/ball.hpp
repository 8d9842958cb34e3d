// A ball as arrays, as a host program passes it; its contact is known analytically.
#pragma once

#include <doctest/doctest.h>
#include <palpate/palpate.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

namespace palpate {

inline constexpr double kBallRadius = 50;

/// Evenly distributed on a sphere (Fibonacci lattice; Swinbank and Purser 2006), with exact normals.
template <class Number>
struct BallArrays {
  std::vector<Number> positions, normals;

  explicit BallArrays(std::size_t count, const std::array<double, 3>& center = {0, 0, 0}) {
    for (std::size_t i = 0; i < count; ++i) {
      const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count), r = std::sqrt(1 - z * z);
      const double turn = 2 * std::numbers::pi * static_cast<double>(i) / std::numbers::phi;
      const std::array<double, 3> normal{r * std::cos(turn), r * std::sin(turn), z};
      for (std::size_t k = 0; k < 3; ++k) {
        positions.push_back(static_cast<Number>(center[k] + kBallRadius * normal[k]));
        normals.push_back(static_cast<Number>(normal[k]));
      }
    }
  }
  std::uint64_t count() const { return positions.size() / 3; }
  pp_cloud_arrays arrays() const {
    pp_cloud_arrays arrays = pp_default_cloud_arrays();
    const int type = sizeof(Number) == sizeof(double) ? PP_FLOAT64 : PP_FLOAT32;
    arrays.count = count();
    arrays.positions = {positions.data(), type, 0, 0};
    arrays.normals = {normals.data(), type, 0, 0};
    return arrays;
  }
};

/// Fails the test with the library's error message.
#define PP_CHECK_OK(call) CHECK_MESSAGE((call) == PP_OK, std::string(pp_last_error()))
#define PP_REQUIRE_OK(call) REQUIRE_MESSAGE((call) == PP_OK, std::string(pp_last_error()))

inline bool lastErrorSays(const std::string& words) {
  return std::string(pp_last_error()).find(words) != std::string::npos;
}

/// The call fails with this status, and the error says these words.
#define PP_CHECK_FAILS(call, status, words)                            \
  do {                                                                 \
    CHECK((call) == (status));                                         \
    CHECK_MESSAGE(lastErrorSays(words), std::string(pp_last_error())); \
  } while (false)

/// A cloud that is open during a test.
struct BallCloud {
  pp_cloud cloud{};
  explicit BallCloud(std::size_t count = 20'000) {
    const BallArrays<float> ball(count);
    const pp_cloud_arrays given = ball.arrays();
    PP_REQUIRE_OK(pp_cloud_create(&given, &cloud));
  }
  ~BallCloud() { pp_cloud_close(cloud); }
  BallCloud(const BallCloud&) = delete;
  BallCloud& operator=(const BallCloud&) = delete;
};

/// On the CPU, with one model unit per millimetre, unless a test changes it.
inline pp_session_options cpuOptions() {
  pp_session_options options = pp_default_session_options();
  options.gpu = "cpu";
  options.mm_per_unit = 1;
  options.threads = 2;
  return options;
}

struct OpenBall {
  BallCloud cloud;
  pp_session session{};
  explicit OpenBall(const pp_session_options& options = cpuOptions(), std::size_t count = 20'000) : cloud(count) {
    PP_REQUIRE_OK(pp_session_open(cloud.cloud, &options, &session));
  }
  ~OpenBall() { pp_session_close(session); }
  OpenBall(const OpenBall&) = delete;
  OpenBall& operator=(const OpenBall&) = delete;
};

/// Down the z axis from above the ball to `depth_mm` below its surface, and at rest there; x y z for each tick.
inline std::vector<double> pressPath(double depth_mm, std::size_t down = 100, std::size_t rest = 100) {
  std::vector<double> path;
  for (std::size_t i = 0; i < down + rest; ++i) {
    const double share = std::min(1.0, static_cast<double>(i) / static_cast<double>(down));
    path.insert(path.end(), {0.3, -0.2, kBallRadius + 2 - share * (2 + depth_mm)});
  }
  return path;
}

inline pp_path pathOf(const std::vector<double>& rows, std::uint32_t columns = 3) {
  pp_path path = pp_default_path();
  path.data = rows.data();
  path.columns = columns;
  path.rows = rows.size() / columns;
  return path;
}

/// Touches along a path, and returns all its ticks.
inline std::vector<pp_tick> touch(pp_session session, const pp_path& path) {
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_path_ticks(session, &path, &count));
  std::vector<pp_tick> ticks(count);
  PP_REQUIRE_OK(pp_session_touch(session, &path, ticks.data(), ticks.size(), &count));
  CHECK(count == ticks.size());
  return ticks;
}

inline std::vector<pp_tick> stroke(pp_session session, const pp_path& path, const pp_brush& brush) {
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_path_ticks(session, &path, &count));
  std::vector<pp_tick> ticks(count);
  PP_REQUIRE_OK(pp_session_stroke(session, &path, &brush, ticks.data(), ticks.size(), &count));
  return ticks;
}

inline double lengthOf(const double (&v)[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// The current points of a session, in file coordinates.
inline std::vector<double> placesOf(pp_session session) {
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_session_cloud(session, &cloud));
  pp_points points{};
  PP_REQUIRE_OK(pp_cloud_view(cloud, &points));
  std::vector<double> places(3 * points.count);
  PP_REQUIRE_OK(pp_cloud_copy_positions(cloud, places.data(), points.count));
  PP_REQUIRE_OK(pp_cloud_close(cloud));
  return places;
}

/// Whether it comes true in time.
template <class Is>
bool comes(double seconds, Is&& is) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!is() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return is();
}

/// Strokes whose brush keeps the density or not, in either order: only the strokes that keep it change the number of
/// points.
inline void checkDensityIsOfTheBrush(const pp_session_options& options) {
  constexpr std::size_t kPoints = 5'000;
  for (const bool firstKeeps : {true, false}) {
    const OpenBall ball(options, kPoints);
    for (const bool keeps : {firstKeeps, !firstKeeps}) {
      pp_brush brush = pp_default_brush();
      brush.radius_mm = 10;
      brush.push_rate = 1;
      brush.resample = keeps ? 1 : 0;
      stroke(ball.session, pathOf(pressPath(6, 30, 10)), brush);
      CAPTURE(firstKeeps);
      CAPTURE(keeps);
      CHECK((placesOf(ball.session).size() != 3 * kPoints) == keeps);
      std::uint64_t done = 0;
      PP_REQUIRE_OK(pp_session_undo(ball.session, 1, &done));
      CHECK(done == 1);
      CHECK(placesOf(ball.session).size() == 3 * kPoints);
    }
  }
}

}  // namespace palpate
