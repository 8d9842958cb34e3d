// Handles that are null, closed, of another kind or made up: an error with a message, never a crash.
#include <atomic>
#include <set>
#include <thread>

#include "tests/library/ball.hpp"

namespace palpate::handles_test {

TEST_CASE("a handle that is null, closed, of another kind or made up is refused by every call") {
  OpenBall ball;
  pp_cloud closed{};
  {
    const BallCloud other(10);
    closed = other.cloud;
  }
  pp_points points{};
  for (const pp_cloud wrong :
       {pp_cloud{}, closed, pp_cloud{ball.session.id}, pp_cloud{~std::uint64_t{0}}, pp_cloud{1},
        pp_cloud{ball.cloud.cloud.id ^ (std::uint64_t{1} << 30)}, pp_cloud{ball.cloud.cloud.id | 0xfff000}}) {
    CAPTURE(wrong.id);
    CHECK(pp_cloud_view(wrong, &points) == PP_ERROR_HANDLE);
    CHECK(pp_cloud_write(wrong, "/tmp/never.ply", nullptr) == PP_ERROR_HANDLE);
    CHECK(pp_cloud_close(wrong) == PP_ERROR_HANDLE);
    CHECK_FALSE(std::string(pp_last_error()).empty());
    pp_session session{};
    CHECK(pp_session_open(wrong, nullptr, &session) == PP_ERROR_HANDLE);
    CHECK(session.id == 0);
  }
  const pp_session wrong{ball.cloud.cloud.id};
  const pp_pose pose{};
  pp_contact contact{};
  PP_CHECK_FAILS(pp_touch(wrong, &pose, &contact), PP_ERROR_HANDLE, "a cloud was given, but a session is required");
  CHECK(pp_session_undo(wrong, 1, nullptr) == PP_ERROR_HANDLE);
  CHECK(pp_live_set_forces(wrong, 0) == PP_ERROR_HANDLE);
  CHECK(pp_mesh_close({ball.session.id}) == PP_ERROR_HANDLE);
  // Valid handles still work.
  PP_CHECK_OK(pp_cloud_view(ball.cloud.cloud, &points));
  CHECK(points.count == 20'000);
}

TEST_CASE("a reused slot gives a new handle, and the old one stays invalid") {
  std::set<std::uint64_t> seen;
  pp_cloud first{};
  for (int i = 0; i < 3'000; ++i) {
    const float place[3]{1, 2, 3};
    pp_cloud_arrays arrays = pp_default_cloud_arrays();
    arrays.count = 1;
    arrays.positions = {place, PP_FLOAT32, 0, 0};
    pp_cloud cloud{};
    PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
    CHECK(seen.insert(cloud.id).second);
    if (i == 0) first = cloud;
    PP_REQUIRE_OK(pp_cloud_close(cloud));
    pp_points points{};
    CHECK(pp_cloud_view(first, &points) == PP_ERROR_HANDLE);
  }
}

TEST_CASE("a session outlives its cloud's handle, and a session closed twice gives an error") {
  pp_session session{};
  {
    const BallCloud ball;
    const pp_session_options options = cpuOptions();
    PP_REQUIRE_OK(pp_session_open(ball.cloud, &options, &session));
  }
  const auto path = pressPath(1);
  CHECK(touch(session, pathOf(path)).back().contact == 1);
  PP_CHECK_OK(pp_session_close(session));
  PP_CHECK_FAILS(pp_session_close(session), PP_ERROR_HANDLE, "closed");
}

TEST_CASE("many handles are open at once, opened and closed by several threads") {
  std::atomic<int> wrong = 0;
  const auto work = [&] {
    std::vector<pp_cloud> open(700);
    const BallArrays<float> ball(2);
    const pp_cloud_arrays arrays = ball.arrays();
    for (int turn = 0; turn < 3; ++turn) {
      for (pp_cloud& cloud : open) wrong += pp_cloud_create(&arrays, &cloud) != PP_OK;
      for (const pp_cloud& cloud : open) {
        pp_points points{};
        wrong += pp_cloud_view(cloud, &points) != PP_OK || points.count != 2;
        wrong += pp_cloud_close(cloud) != PP_OK;
        wrong += pp_cloud_close(cloud) != PP_ERROR_HANDLE;
      }
    }
  };
  std::thread one(work), two(work);
  work();
  one.join();
  two.join();
  CHECK(wrong == 0);
}

}  // namespace palpate::handles_test
