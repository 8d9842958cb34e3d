// Concurrent use of one session, in permitted and in forbidden ways; and calls that run out of memory.
#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "tests/allocation_count.hpp"
#include "tests/library/serving.hpp"

namespace palpate::threads_test {

namespace {

pp_pose poseAt(std::size_t tick, double z) { return {.t_s = 1e-3 * static_cast<double>(tick), .hip = {0.3, -0.2, z}}; }

// Status of a call in which all allocations but the first ones fail, on any thread.
pp_status withMemoryFor(int most, const std::function<pp_status()>& call) {
  allocations = 0;
  mostAllocations = most;
  counting = true;
  const pp_status status = call();
  counting = false;
  mostAllocations = std::numeric_limits<int>::max();
  return status;
}

// The brush is pressed into the ball at the end of an axis, from outside.
struct Press {
  std::vector<double> poses = std::vector<double>(3 * 60, 0.0);
  std::vector<pp_tick> ticks = std::vector<pp_tick>(60);

  explicit Press(std::size_t axis) {
    for (std::size_t i = 0; i < 60; ++i) poses[3 * i + axis] = 52 - 0.1 * static_cast<double>(i);
  }
  // Itself without an allocation.
  pp_status on(pp_session session) {
    const pp_path path = pathOf(poses);
    pp_brush brush = pp_default_brush();
    brush.resample = 0;
    std::uint64_t count = 0;
    return pp_session_stroke(session, &path, &brush, ticks.data(), ticks.size(), &count);
  }
};

}  // namespace

TEST_CASE("an object that cannot be opened for lack of memory harms no handle that is opened later") {
  const BallArrays<float> arrays(10);
  const pp_cloud_arrays given = arrays.arrays();
  std::vector<pp_cloud> clouds(1100);  // more than the table of handles grows by
  for (pp_cloud& cloud : clouds) {
    pp_status status = PP_ERROR_MEMORY;
    for (int most = 0; status != PP_OK; ++most) {
      status = withMemoryFor(most, [&] { return pp_cloud_create(&given, &cloud); });
      REQUIRE((status == PP_OK || (status == PP_ERROR_MEMORY && cloud.id == 0)));
    }
  }
  for (const pp_cloud cloud : clouds) {
    pp_points points{};
    REQUIRE(pp_cloud_view(cloud, &points) == PP_OK);
    CHECK(points.count == 10);
    PP_CHECK_OK(pp_cloud_close(cloud));
  }
}

TEST_CASE("a stroke that runs out of memory costs no earlier stroke") {
  std::size_t failed = 0;
  Press above(2), beside(0);
  pp_status status = PP_ERROR_MEMORY;
  for (int most = 0; status != PP_OK; ++most) {
    CAPTURE(most);
    const OpenBall ball(cpuOptions(), 2000);
    const std::vector<double> before = placesOf(ball.session);
    PP_REQUIRE_OK(above.on(ball.session));
    const std::vector<double> dented = placesOf(ball.session);
    REQUIRE(dented != before);
    status = withMemoryFor(most, [&] { return beside.on(ball.session); });
    if (status == PP_OK) break;
    ++failed;
    CHECK(status == PP_ERROR_MEMORY);
    const std::vector<double> now = placesOf(ball.session);
    std::size_t lost = 0;
    for (std::size_t i = 0; i < before.size(); ++i) lost += dented[i] != before[i] && now[i] != dented[i];
    CHECK(lost == 0);
  }
  CHECK(failed > 5);
}

TEST_CASE("a session whose first stroke runs out of memory can be used and closed") {
  Press above(2);
  pp_status status = PP_ERROR_MEMORY;
  for (int most = 0; status != PP_OK; most += 11) {
    CAPTURE(most);
    const OpenBall ball(cpuOptions(), 1000);
    status = withMemoryFor(most, [&] { return above.on(ball.session); });
    CHECK((status == PP_OK || status == PP_ERROR_MEMORY));
    const pp_status again = above.on(ball.session);
    CHECK((again == PP_OK || again == PP_ERROR_MEMORY));
    CHECK(placesOf(ball.session).size() == 3000);
  }
}

TEST_CASE("a tick of a host's own servo loop allocates nothing, nor does it to tell of a contact") {
  pp_session_options options = cpuOptions();
  SUBCASE("without a budget") {}
  SUBCASE("with a budget") { options.budget_us = 500; }
  const OpenBall ball(options);
  int begun = 0;
  PP_REQUIRE_OK(pp_session_on_contact(
      ball.session, [](void* user, const pp_contact_event* event) { *static_cast<int*>(user) += event->begins != 0; },
      &begun));
  pp_contact contact{};
  pp_pose pose = poseAt(0, 52);
  PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
  countedThread = std::this_thread::get_id();
  allocations = 0;
  int wrong = 0;
  counting = true;
  for (std::size_t i = 1; i < 400; ++i) {
    pose = poseAt(i, 52 - 0.01 * static_cast<double>(i));
    wrong += pp_touch(ball.session, &pose, &contact) != PP_OK;
  }
  counting = false;
  CHECK(wrong == 0);
  CHECK(contact.contact == 1);
  CHECK(begun == 1);
  CHECK(allocations == 0);
  counting = true;  // control: allocations of the library are counted
  pp_cloud copy{};
  wrong += pp_session_cloud(ball.session, &copy) != PP_OK;
  counting = false;
  countedThread = std::thread::id();
  CHECK(wrong == 0);
  CHECK(allocations > 3);
  PP_CHECK_OK(pp_cloud_close(copy));
}

TEST_CASE("a tick on a joined cloud allocates nothing") {
  if (!isBuilt()) return;
  const Serving serving("ticked");
  pp_session_options options = cpuOptions();
  options.budget_us = 500;
  const pp_session session = joined("ticked", "anna", options);
  pp_contact contact{};
  pp_pose pose = poseAt(0, 52);
  PP_REQUIRE_OK(pp_touch(session, &pose, &contact));
  countedThread = std::this_thread::get_id();
  allocations = 0;
  int wrong = 0;
  counting = true;
  for (std::size_t i = 1; i < 400; ++i) {
    pose = poseAt(i, 52 - 0.01 * static_cast<double>(i));
    wrong += pp_touch(session, &pose, &contact) != PP_OK;
  }
  counting = false;
  countedThread = std::thread::id();
  CHECK(wrong == 0);
  CHECK(contact.contact == 1);
  CHECK(allocations == 0);
  PP_CHECK_OK(pp_session_close(session));
}

TEST_CASE("one thread touches and sculpts while another applies its edits") {
  pp_session_options options = cpuOptions();
  options.budget_us = 2'000;
  const OpenBall ball(options);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 5;
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
  const auto before = placesOf(ball.session);
  std::atomic<bool> done = false;
  std::atomic<int> wrong = 0;
  std::thread servo([&] {
    pp_contact contact{};
    for (std::size_t i = 0; i < 500; ++i) {
      const pp_pose pose = poseAt(i, 52 - 0.012 * static_cast<double>(i));
      wrong += pp_touch(ball.session, &pose, &contact) != PP_OK;
    }
    done = true;
  });
  pp_session_info info = pp_default_session_info();
  while (!done) {
    wrong += pp_session_apply_edits(ball.session) != PP_OK;
    wrong += pp_session_get_info(ball.session, &info) != PP_OK;
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  servo.join();
  CHECK(wrong == 0);
  CHECK(placesOf(ball.session) != before);
  PP_REQUIRE_OK(pp_session_undo(ball.session, 100, nullptr));
  CHECK(placesOf(ball.session) == before);
}

TEST_CASE("a call that conflicts with one in progress returns an error, and the session stays usable") {
  // The law is called in the middle of pp_session_touch(), on a thread of its own.
  struct Shared {
    pp_session session{};
    std::atomic<bool> inside = false, goOn = false;
  } shared;
  pp_session_options options = cpuOptions();
  options.law_user = &shared;
  options.law = [](void* user, const pp_pose*, const pp_contact* contact, double, double force_N[3]) {
    auto& its = *static_cast<Shared*>(user);
    its.inside = true;
    while (!its.goOn) std::this_thread::yield();
    for (int k = 0; k < 3; ++k) force_N[k] = contact->force_N[k];
  };
  OpenBall ball(options);
  shared.session = ball.session;
  const auto press = pressPath(1);
  std::thread other([&] { touch(shared.session, pathOf(press)); });
  while (!shared.inside) std::this_thread::yield();
  pp_session_info info = pp_default_session_info();
  const pp_pose pose{};
  pp_contact contact{};
  CHECK(pp_session_get_info(ball.session, &info) == PP_ERROR_THREAD);
  CHECK(pp_touch(ball.session, &pose, &contact) == PP_ERROR_THREAD);
  CHECK(pp_session_undo(ball.session, 1, nullptr) == PP_ERROR_THREAD);
  CHECK(pp_session_close(ball.session) == PP_ERROR_THREAD);
  CHECK_FALSE(std::string(pp_last_error()).empty());
  shared.goOn = true;
  other.join();
  PP_CHECK_OK(pp_session_get_info(ball.session, &info));
  CHECK(touch(ball.session, pathOf(press)).back().contact == 1);
}

TEST_CASE("several sessions on one cloud are touched by as many threads") {
  const BallCloud cloud;
  const auto press = pressPath(1);
  std::vector<double> last(12);
  std::vector<std::thread> threads;
  for (double& force_N : last)
    threads.emplace_back([&] {
      const pp_session_options options = cpuOptions();
      pp_session session{};
      PP_REQUIRE_OK(pp_session_open(cloud.cloud, &options, &session));
      force_N = touch(session, pathOf(press)).back().force_N[2];
      PP_CHECK_OK(pp_session_close(session));
    });
  for (std::thread& thread : threads) thread.join();
  for (const double force_N : last) CHECK(force_N == last.front());
  CHECK(last.front() > 0.5);
}

}  // namespace palpate::threads_test
