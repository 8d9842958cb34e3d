// Nearest positions, ray casts and rows through the C interface, on a ball whose surface is known.
#include <atomic>
#include <limits>
#include <thread>

#include "tests/library/ball.hpp"
#include "tests/near.hpp"

namespace palpate::queries_test {

namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

pp_rows rowsOf(const std::vector<double>& numbers) { return {numbers.data(), PP_FLOAT64, 0, 0}; }

std::vector<pp_surface_point> nearest(pp_session session, const std::vector<double>& positions,
                                      double within = kEndless) {
  std::vector<pp_surface_point> found(positions.size() / 3);
  const pp_rows rows = rowsOf(positions);
  PP_REQUIRE_OK(pp_session_nearest(session, &rows, found.size(), within, found.data()));
  return found;
}

std::vector<pp_surface_point> cast(pp_session session, const std::vector<double>& from,
                                   const std::vector<double>& along, double longest = kEndless) {
  std::vector<pp_surface_point> found(from.size() / 3);
  const pp_rows origins = rowsOf(from), directions = rowsOf(along);
  PP_REQUIRE_OK(pp_session_raycast(session, &origins, &directions, found.size(), longest, found.data()));
  return found;
}

pp_session_options withSurface(const char* surface, pp_contact_options& contact) {
  contact = pp_default_contact_options();
  contact.surface = surface;
  pp_session_options options = cpuOptions();
  options.contact = &contact;
  return options;
}

std::vector<pp_row> rowsOf(pp_session session) {
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_session_rows(session, nullptr, 0, &count));
  std::vector<pp_row> rows(count);
  PP_REQUIRE_OK(pp_session_rows(session, rows.data(), count, &count));
  return rows;
}

}  // namespace

TEST_CASE("nearest positions and rays meet the ball, far from zero too, and many at once as one by one") {
  const std::array<double, 3> center{4e6, -3e6, 2e5};  // float32 resolves a quarter of a unit there
  const BallArrays<double> arrays(20'000, center);
  const pp_cloud_arrays given = arrays.arrays();
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&given, &cloud));
  pp_contact_options contact;
  const pp_session_options options = withSurface("sphere", contact);
  pp_session session{};
  PP_REQUIRE_OK(pp_session_open(cloud, &options, &session));
  std::vector<double> from, along;
  for (int i = 0; i < 200; ++i) {
    const double turn = 0.7 * i, z = std::sin(1.3 * i);
    const std::array<double, 3> out{std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z};
    for (std::size_t k = 0; k < 3; ++k) {
      from.push_back(center[k] + 75 * out[k]);
      along.push_back(-1e-3 * out[k]);
    }
  }
  const auto feet = nearest(session, from), hits = cast(session, from, along);
  for (std::size_t i = 0; i < feet.size(); ++i)
    for (const pp_surface_point& point : {feet[i], hits[i]}) {
      REQUIRE(point.found == 1);
      CHECK(point.behind == 0);
      CHECK(point.distance == within(25, 0.01));
      for (std::size_t k = 0; k < 3; ++k) {
        const double out = (from[3 * i + k] - center[k]) / 75;
        CHECK(point.position[k] == within(center[k] + 50 * out, 0.02));
        CHECK(point.normal[k] == within(out, 0.02));
        CHECK(arrays.positions[3 * point.row + k] == within(point.position[k], 1));
      }
      CHECK(point.cloud == 0);
    }
  const std::vector<double> one(from.begin() + 30, from.begin() + 33);
  CHECK(nearest(session, one).front().distance == feet[10].distance);
  CHECK(nearest(session, one, 24).front().found == 0);
  PP_CHECK_OK(pp_session_close(session));
  PP_CHECK_OK(pp_cloud_close(cloud));
}

TEST_CASE("the nearest position is where the hand's proxy lies, and a ray along its force hits there") {
  for (const char* surface : {"average", "sphere", "sharp"}) {
    CAPTURE(surface);
    pp_contact_options contact;
    const OpenBall ball(withSurface(surface, contact));
    const auto path = pressPath(1.5);
    const pp_tick tick = touch(ball.session, pathOf(path)).back();
    const std::vector<double> hip(tick.hip, tick.hip + 3), normal(tick.normal, tick.normal + 3);
    const pp_surface_point foot = nearest(ball.session, hip).front(), hit = cast(ball.session, hip, normal).front();
    for (const pp_surface_point& point : {foot, hit}) {
      REQUIRE(point.found == 1);
      CHECK(point.behind == 1);
      CHECK(point.distance == near(tick.penetration_mm, 1e-3));
      for (int k = 0; k < 3; ++k) CHECK(point.position[k] == within(tick.proxy[k], 2e-3));
    }
  }
}

TEST_CASE("queries follow edits, undo, and a changed kind of surface") {
  const OpenBall ball;
  const std::vector<double> above{0.3, -0.2, 60}, down{0, 0, -1};
  const double before = cast(ball.session, above, down).front().distance;
  CHECK(before == within(10, 0.2));
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 8;
  stroke(ball.session, pathOf(pressPath(4)), brush);
  const double dented = cast(ball.session, above, down).front().distance;
  CHECK(dented > before + 0.5);
  std::uint64_t done = 0;
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, &done));
  CHECK(cast(ball.session, above, down).front().distance == before);
  pp_contact_options contact = pp_default_contact_options();
  contact.surface = "sphere";
  PP_REQUIRE_OK(pp_session_set_contact(ball.session, &contact));
  const double outward = before - cast(ball.session, above, down).front().distance;  // averaging shrinks a ball
  CHECK(outward > 0.01);
  CHECK(outward < 0.3);
}

TEST_CASE("rows name the points that a stroke has moved or inserted, and leave out those that are gone") {
  const OpenBall ball(cpuOptions(), 5'000);
  const auto opened = rowsOf(ball.session);
  REQUIRE(opened.size() == 5'000);
  for (std::size_t i = 0; i < opened.size(); ++i) CHECK((opened[i].row == i && opened[i].changed == 0));
  const auto before = placesOf(ball.session);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 10;
  brush.push_rate = 1;
  stroke(ball.session, pathOf(pressPath(6, 30, 10)), brush);
  const auto rows = rowsOf(ball.session);
  const auto after = placesOf(ball.session);
  REQUIRE(3 * rows.size() == after.size());
  std::size_t moved = 0, inserted = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].cloud == PP_INSERTED) {
      ++inserted;
      CHECK(rows[i].changed == 1);
      continue;
    }
    const bool isSame = std::equal(&after[3 * i], &after[3 * i] + 3, &before[3 * rows[i].row]);
    CHECK(rows[i].cloud == 0);
    CHECK(isSame == (rows[i].changed == 0));
    moved += !isSame;
  }
  CHECK(moved > 20);
  CHECK(inserted > 0);
  std::uint64_t count = 0;
  std::vector<pp_row> few(3);
  CHECK(pp_session_rows(ball.session, few.data(), few.size(), &count) == PP_ERROR_ARGUMENT);
  CHECK(count == 0);
}

TEST_CASE("a query that cannot be answered is refused with its row, and finds nothing") {
  const OpenBall ball(cpuOptions(), 2'000);
  const std::vector<double> from{0, 0, 60, 0, 0, 70}, zero{0, 0, -1, 0, 0, 0},
      bad{0, 0, 60, 0, std::numeric_limits<double>::quiet_NaN(), 1};
  const pp_rows origins = rowsOf(from), zeros = rowsOf(zero), bads = rowsOf(bad);
  std::vector<pp_surface_point> found(2);
  const auto refused = [&](pp_status status, const char* words) {
    CHECK(status == PP_ERROR_ARGUMENT);
    CHECK_MESSAGE(lastErrorSays(words), pp_last_error());
    for (pp_surface_point& each : found) {
      CHECK(each.found == 0);
      each.found = 1;
    }
  };
  found[0].found = found[1].found = 1;
  refused(pp_session_nearest(ball.session, &bads, 2, kEndless, found.data()), "positions: row 1");
  refused(pp_session_raycast(ball.session, &origins, &zeros, 2, kEndless, found.data()), "directions: row 1: is 0");
  refused(pp_session_raycast(ball.session, &bads, &origins, 2, kEndless, found.data()), "origins: row 1");
  refused(pp_session_nearest(ball.session, &origins, 2, -1, found.data()), "max_distance");
  refused(pp_session_nearest(ball.session, &origins, 2, std::nan(""), found.data()), "max_distance");
  refused(pp_session_nearest(ball.session, nullptr, 2, 1, found.data()), "positions");
  CHECK(pp_session_nearest(ball.session, &origins, 2, 1, nullptr) == PP_ERROR_ARGUMENT);
  PP_CHECK_OK(pp_session_nearest(ball.session, &origins, 0, 1, nullptr));
}

TEST_CASE("a cloud of one point has no surface to be hit") {
  const float point[3]{1, 2, 3}, up[3]{0, 0, 1};
  pp_cloud_arrays arrays = pp_default_cloud_arrays();
  arrays.count = 1;
  arrays.positions.data = point;
  arrays.normals.data = up;
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
  const pp_session_options options = cpuOptions();
  pp_session session{};
  PP_REQUIRE_OK(pp_session_open(cloud, &options, &session));
  CHECK(nearest(session, {1, 2, 4}).front().found == 0);
  CHECK(cast(session, {1, 2, 9}, {0, 0, -1}).front().found == 0);
  PP_CHECK_OK(pp_session_close(session));
  PP_CHECK_OK(pp_cloud_close(cloud));
}

TEST_CASE("rays are cast while another thread touches and sculpts") {
  pp_session_options options = cpuOptions();
  options.budget_us = 2'000;
  const OpenBall ball(options);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 8;
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
  const std::vector<double> above{0.3, -0.2, 60}, down{0, 0, -1};
  const double before = cast(ball.session, above, down).front().distance;
  std::atomic<bool> done = false;
  std::atomic<int> wrong = 0;
  std::thread toucher([&] {
    for (int i = 0; i < 400; ++i) {
      const pp_pose pose{.t_s = 1e-3 * i, .hip = {0.3, -0.2, 52 - 0.015 * i}};
      pp_contact contact{};
      wrong += pp_touch(ball.session, &pose, &contact) != PP_OK || contact.valid == 0;
      std::this_thread::yield();
    }
    done = true;
  });
  double deepest = before;
  while (!done) {
    const double now = cast(ball.session, above, down).front().distance;
    CHECK(now >= before - 0.5);
    deepest = std::max(deepest, now);
  }
  toucher.join();
  CHECK(wrong == 0);
  CHECK(std::max(deepest, cast(ball.session, above, down).front().distance) > before + 0.5);
}

}  // namespace palpate::queries_test
