#include "apps/view/picture_pace.hpp"

#include <doctest/doctest.h>

namespace palpate::picture_pace_test {

TEST_CASE("a picture is timed from the oldest motion of the mouse that it shows first") {
  PicturePace pace;
  pace.begin();
  pace.noteMouse(0.25);
  pace.noteMouse(0.5);
  pace.noteMouse(0.125);
  pace.end(true, true);
  CHECK(pace.mouseToPicture_ms().empty());  // not finished yet
  pace.finish();
  REQUIRE(pace.mouseToPicture_ms().size() == 1);
  CHECK(pace.mouseToPicture_ms().front() >= 500);
  CHECK(pace.mouseToPicture_ms().front() < 5500);

  pace.begin();
  pace.noteMouse(0.5);
  pace.end(true, false);  // the model was not drawn: the motion changed nothing of it
  pace.begin();
  pace.end(true, true);
  pace.finish();
  CHECK(pace.mouseToPicture_ms().size() == 1);
}

}  // namespace palpate::picture_pace_test
