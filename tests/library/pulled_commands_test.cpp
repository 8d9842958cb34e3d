// Commands between the ticks of a program's own servo loop: the hand keeps its contact.
#include <functional>
#include <string>

#include "tests/library/serving.hpp"
#include "tests/near.hpp"

namespace palpate::pulled_commands_test {

namespace {

/// A hand at 1 kHz that is pushed in along the z axis.
struct Presser {
  pp_session session;
  double t_s = 0;

  pp_contact at(double depth_mm) {
    const pp_pose pose{.t_s = t_s += 1e-3, .hip = {0.3, -0.2, kBallRadius - depth_mm}};
    pp_contact contact{};
    PP_REQUIRE_OK(pp_touch(session, &pose, &contact));
    return contact;
  }
  /// From above the ball to 1 mm below its surface.
  pp_contact press() {
    PP_REQUIRE_OK(pp_touch_lift(session));
    for (int i = 0; i < 200; ++i) at(-1 + 0.01 * i);
    return at(1);
  }
};

}  // namespace

TEST_CASE("a hand in its own servo loop keeps contact and force through every command") {
  const OpenBall ball;
  Presser hand{ball.session};
  int events = 0;
  const auto count = [](void* user, const pp_contact_event*) { ++*static_cast<int*>(user); };
  PP_REQUIRE_OK(pp_session_on_contact(ball.session, count, &events));
  const pp_brush paint = [] {
    pp_brush brush = pp_default_brush();
    brush.kind = "paint";
    brush.yield_depth_mm = 5;
    return brush;
  }();
  pp_brush other = paint;
  other.radius_mm = 3;
  struct Command {
    std::string name;
    std::function<void(pp_session)> give;
  };
  const std::vector<Command> commands{
      {"record", [](pp_session s) { PP_REQUIRE_OK(pp_session_record(s, "pulled.log")); }},
      {"first brush", [&](pp_session s) { PP_REQUIRE_OK(pp_session_set_brush(s, &paint)); }},
      {"other brush", [&](pp_session s) { PP_REQUIRE_OK(pp_session_set_brush(s, &other)); }},
      {"no brush", [](pp_session s) { PP_REQUIRE_OK(pp_session_set_brush(s, nullptr)); }},
      {"undo", [](pp_session s) { PP_REQUIRE_OK(pp_session_undo(s, 1, nullptr)); }},
      {"redo", [](pp_session s) { PP_REQUIRE_OK(pp_session_redo(s, 1, nullptr)); }},
      {"cloud", [](pp_session s) { placesOf(s); }},
  };
  for (const Command& command : commands) {
    CAPTURE(command.name);
    const pp_contact before = hand.press();
    REQUIRE(before.contact == 1);
    const int heard = events;
    command.give(ball.session);
    const pp_contact after = hand.at(1);
    CHECK(after.contact == 1);
    CHECK(after.withheld == 0);
    CHECK(after.penetration_mm == near(before.penetration_mm, 1e-3));
    CHECK(lengthOf(after.force_N) == near(0.8 * before.penetration_mm, 0.01));
    CHECK(events == heard);
  }
  const pp_contact before = hand.press();
  pp_contact_options stiffer = pp_default_contact_options();
  stiffer.stiffness_N_per_mm = 1;
  PP_REQUIRE_OK(pp_session_set_contact(ball.session, &stiffer));
  const pp_contact after = hand.at(1);
  CHECK(after.contact == 1);
  CHECK(lengthOf(after.force_N) > lengthOf(before.force_N));  // it rises gradually
  for (int i = 0; i < 20; ++i) hand.at(1);
  CHECK(lengthOf(hand.at(1).force_N) == near(before.penetration_mm, 0.01));
  stiffer.surface = "sphere";
  PP_REQUIRE_OK(pp_session_set_contact(ball.session, &stiffer));
  CHECK(lengthOf(hand.at(1).force_N) == near(before.penetration_mm, 0.1));
}

TEST_CASE("a dent that is undone under a hand pushes it again") {
  const OpenBall ball;
  Presser hand{ball.session};
  const double whole_mm = hand.press().penetration_mm;
  const pp_brush brush = pp_default_brush();
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
  for (int i = 0; i < 100; ++i) hand.at(1);
  const double dented_mm = hand.at(1).penetration_mm;
  CHECK(dented_mm < 0.8 * whole_mm);
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, nullptr));
  std::uint64_t done = 0;
  PP_REQUIRE_OK(pp_session_undo(ball.session, 9, &done));
  CHECK(done >= 1);
  const pp_contact after = hand.at(1);
  CHECK(after.contact == 1);
  CHECK(after.penetration_mm == near(whole_mm, 0.05));
}

TEST_CASE(
    "a stroke that is cancelled under a hand is gone to the bit, and the hand dents nothing before it is lifted") {
  for (const char* const symmetry : {"", "x"}) {
    CAPTURE(symmetry);
    const OpenBall ball;
    Presser hand{ball.session};
    pp_brush brush = pp_default_brush();
    brush.symmetry = symmetry;
    PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
    const std::vector<double> before = placesOf(ball.session);
    std::uint32_t cancelled = 9;
    PP_REQUIRE_OK(pp_session_cancel_stroke(ball.session, &cancelled));
    CHECK(cancelled == 0);
    hand.press();
    for (int i = 0; i < 100; ++i) hand.at(1);
    PP_REQUIRE_OK(pp_session_cancel_stroke(ball.session, &cancelled));
    CHECK(cancelled == 1);
    CHECK(placesOf(ball.session) == before);
    CHECK(hand.at(1).contact == 1);
    for (int i = 0; i < 100; ++i) hand.at(1);
    CHECK(placesOf(ball.session) == before);
    pp_session_info info = pp_default_session_info();
    PP_REQUIRE_OK(pp_session_get_info(ball.session, &info));
    CHECK(info.undo_count == 0);
    CHECK(info.redo_count == 0);
    hand.press();
    for (int i = 0; i < 100; ++i) hand.at(1);
    CHECK(placesOf(ball.session) != before);
  }
  const OpenBall ball;
  pp_brush brush = pp_default_brush();
  brush.symmetry = "up";
  CHECK(pp_session_set_brush(ball.session, &brush) == PP_ERROR_ARGUMENT);
}

TEST_CASE("a hand in a joined session keeps its contact while a command delivers its strokes to the server") {
  if (!isBuilt()) return;
  const Serving serving("pulled");
  const pp_session session = joined("pulled", "anna");
  Presser hand{session};
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 5;
  PP_REQUIRE_OK(pp_session_set_brush(session, &brush));
  hand.press();
  const pp_contact before = hand.at(1.5);
  REQUIRE(before.contact == 1);
  CHECK(sharingOf(session).delivered == 0);
  pointsOf(session);
  CHECK(sharingOf(session).delivered == 1);
  const pp_contact after = hand.at(1.5);
  CHECK(after.contact == 1);
  CHECK(lengthOf(after.force_N) > 0.5 * lengthOf(before.force_N));
  PP_CHECK_OK(pp_session_close(session));
}

TEST_CASE("a hand that begins in the surface, or continues after a path, touches nothing until it has left") {
  const OpenBall ball;
  Presser hand{ball.session};
  const auto checkBeginsFree = [&] {
    for (int i = 0; i < 50; ++i) {
      const pp_contact within = hand.at(1);
      CHECK(within.contact == 0);
      CHECK(within.valid == 1);
      CHECK(lengthOf(within.force_N) == 0);
    }
    for (int i = 0; i < 100; ++i) hand.at(-1);
    for (int i = 0; i < 100; ++i) hand.at(-1 + 0.02 * i);
    CHECK(hand.at(1).contact == 1);
  };
  checkBeginsFree();
  touch(ball.session, pathOf(pressPath(1)));
  checkBeginsFree();
}

}  // namespace palpate::pulled_commands_test
