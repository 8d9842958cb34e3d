// Layers of strokes: their strength slides after the fact, in a program's session.
#include "tests/library/ball.hpp"
#include "tests/near.hpp"

namespace palpate::layers_test {

TEST_CASE("a program slides the strokes of a layer, hides and merges them, and undoes each") {
  const OpenBall ball(cpuOptions(), 5'000);
  const std::vector<double> before = placesOf(ball.session);
  PP_REQUIRE_OK(pp_session_open_layer(ball.session, "dent"));
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 8;
  const std::vector<double> path = pressPath(3);
  stroke(ball.session, pathOf(path), brush);
  const std::vector<double> after = placesOf(ball.session);
  CHECK(after != before);
  double strength = 0;
  std::uint32_t hidden = 1;
  std::uint64_t points = 0, done = 0;
  PP_REQUIRE_OK(pp_session_layer(ball.session, "dent", &strength, &hidden, &points));
  CHECK(strength == 1);
  CHECK(hidden == 0);
  CHECK(points > 10);
  PP_REQUIRE_OK(pp_session_slide_layer(ball.session, "dent", 0.4, 0));
  PP_REQUIRE_OK(pp_session_slide_layer(ball.session, "dent", 0, 1));
  CHECK(placesOf(ball.session) == before);
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, &done));
  CHECK(done == 1);
  CHECK(placesOf(ball.session) == after);
  PP_REQUIRE_OK(pp_session_hide_layer(ball.session, "dent", 1));
  CHECK(placesOf(ball.session) == before);
  PP_REQUIRE_OK(pp_session_layer(ball.session, "dent", &strength, &hidden, nullptr));
  CHECK(strength == 1);
  CHECK(hidden == 1);
  PP_REQUIRE_OK(pp_session_hide_layer(ball.session, "dent", 0));
  PP_REQUIRE_OK(pp_session_merge_layer(ball.session, "dent"));
  CHECK(placesOf(ball.session) == after);
  PP_CHECK_FAILS(pp_session_slide_layer(ball.session, "dent", 0, 0), PP_ERROR_ARGUMENT, "named 'dent'");
  PP_REQUIRE_OK(pp_session_open_layer(ball.session, "dent"));
  PP_REQUIRE_OK(pp_session_layer(ball.session, "dent", nullptr, nullptr, &points));
  CHECK(points == 0);
  PP_REQUIRE_OK(pp_session_open_layer(ball.session, nullptr));
  PP_CHECK_FAILS(pp_session_slide_layer(ball.session, "dent", 2.5, 0), PP_ERROR_ARGUMENT, "not between -1 and 2");
  PP_CHECK_FAILS(pp_session_slide_layer(ball.session, nullptr, 1, 0), PP_ERROR_ARGUMENT, "name: is null");
  PP_CHECK_FAILS(pp_session_hide_layer(ball.session, "other", 1), PP_ERROR_ARGUMENT, "named 'other'");
}

}  // namespace palpate::layers_test
