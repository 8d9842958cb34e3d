// Queries and contact events of a session that a GPU answers.
#include <cstdlib>
#include <limits>

#include "tests/library/ball.hpp"
#include "tests/near.hpp"

namespace palpate::queries_gpu_test {

TEST_CASE("on a GPU the nearest position is the hand's proxy, rays follow a stroke, and contacts are told") {
  pp_session_options options = cpuOptions();
  const char* const named = std::getenv("PALPATE_GPU");
  options.gpu = named ? named : "0";
  const OpenBall ball(options, 5'000);
  std::vector<pp_contact_event> events;
  PP_REQUIRE_OK(pp_session_on_contact(
      ball.session,
      [](void* user, const pp_contact_event* event) {
        static_cast<std::vector<pp_contact_event>*>(user)->push_back(*event);
      },
      &events));
  const auto path = pressPath(1, 20, 10);
  pp_contact contact{};
  for (std::size_t i = 0; i < path.size() / 3; ++i) {
    const pp_pose pose{.t_s = 1e-3 * static_cast<double>(i), .hip = {path[3 * i], path[3 * i + 1], path[3 * i + 2]}};
    PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
  }
  REQUIRE(contact.contact == 1);
  REQUIRE(events.size() == 1);
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  pp_surface_point foot{};
  const pp_rows hip{&path[path.size() - 3], PP_FLOAT64, 0, 0};
  PP_REQUIRE_OK(pp_session_nearest(ball.session, &hip, 1, kEndless, &foot));
  REQUIRE(foot.found == 1);
  for (int k = 0; k < 3; ++k) CHECK(foot.position[k] == within(contact.proxy[k], 5e-3));
  const std::array<double, 3> above{0.3, -0.2, 60}, down{0, 0, -1};
  const pp_rows origin{above.data(), PP_FLOAT64, 0, 0}, direction{down.data(), PP_FLOAT64, 0, 0};
  const auto depthOf = [&] {
    pp_surface_point hit{};
    PP_REQUIRE_OK(pp_session_raycast(ball.session, &origin, &direction, 1, kEndless, &hit));
    REQUIRE(hit.found == 1);
    return hit.distance;
  };
  const double before = depthOf();
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 8;
  stroke(ball.session, pathOf(pressPath(4, 30, 10)), brush);
  CHECK(events.size() == 4);  // the end of the first contact, and the whole of the stroke's
  CHECK(depthOf() > before + 0.3);
  std::uint64_t done = 0;
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, &done));
  CHECK(depthOf() == before);
}

}  // namespace palpate::queries_gpu_test
