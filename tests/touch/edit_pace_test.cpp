#include "engine/touch/edit_pace.hpp"

#include <doctest/doctest.h>

namespace palpate::edit_pace_test {

TEST_CASE(
    "edits within the limit never pause; slow ones pause for their duration, then twice that, until one is fast") {
  EditPace pace(0.02);
  CHECK(pace.mayEdit(0));
  pace.took(0, 0.019);
  CHECK(pace.mayEdit(0.001));

  pace.took(1, 0.05);
  CHECK_FALSE(pace.mayEdit(1.049));
  CHECK(pace.mayEdit(1.051));
  pace.took(2, 0.05);
  CHECK_FALSE(pace.mayEdit(2.099));
  CHECK(pace.mayEdit(2.101));
  pace.took(3, 0.05);
  CHECK_FALSE(pace.mayEdit(3.199));
  CHECK(pace.mayEdit(3.201));

  pace.took(4, 0.001);
  CHECK(pace.mayEdit(4.001));
  pace.took(5, 0.05);
  CHECK(pace.mayEdit(5.051));

  // A single hitch, however long, at most doubles the rest.
  pace.took(6, 0.001);
  pace.took(7, 0.4);
  CHECK_FALSE(pace.mayEdit(7.399));
  CHECK(pace.mayEdit(7.401));
}

TEST_CASE("however often edits are slow, the pause is at most ten times as long as one of them") {
  EditPace pace(0.02);
  for (int i = 0; i < 60; ++i) pace.took(i, 0.05);
  CHECK_FALSE(pace.mayEdit(59.499));
  CHECK(pace.mayEdit(59.501));
  pace.took(60, 0.3);
  CHECK_FALSE(pace.mayEdit(60.999));
  CHECK(pace.mayEdit(61.001));
  // After hitches of different lengths the rest follows the last one.
  pace.took(70, 0.021);
  CHECK_FALSE(pace.mayEdit(70.209));
  CHECK(pace.mayEdit(70.211));
}

TEST_CASE("an edit in time never makes the next one wait, also when it began after the next one's time") {
  EditPace pace(0.02);
  pace.took(0.005, 0.001);  // the edits that bring a hand to its end run ahead of the session's time
  CHECK(pace.mayEdit(0.003));
  pace.took(0.005, 0.05);
  CHECK_FALSE(pace.mayEdit(0.003));
}

TEST_CASE("in virtual time work may be a second ahead of the hand, then edits wait; at the end of a stroke three") {
  WorkPace pace;
  for (int tick = 0; tick < 1000; ++tick) {
    CHECK(pace.mayEdit(1e-3 * tick));
    pace.took(1e-3 * tick, 140e3);  // as much as fits into a tick
  }
  pace.took(1, 1.01 * 140e6);
  CHECK_FALSE(pace.mayEdit(1));
  CHECK(pace.mayEdit(1.02));
  CHECK(pace.mayComplete(1));
  pace.took(1.02, 2 * 140e6);
  CHECK_FALSE(pace.mayComplete(1));
  CHECK(pace.mayComplete(1.05));
}

}  // namespace palpate::edit_pace_test
