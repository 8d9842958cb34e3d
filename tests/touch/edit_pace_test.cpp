#include "engine/touch/edit_pace.hpp"

#include <doctest/doctest.h>

namespace palpate {

TEST_CASE("edits in time never rest; a slow one rests tenfold, the next twice that, and one in time ends it") {
  EditPace pace(0.02);
  CHECK(pace.mayEdit(0));
  pace.took(0, 0.019);
  CHECK(pace.mayEdit(0.001));

  pace.took(1, 0.05);
  CHECK_FALSE(pace.mayEdit(1.49));
  CHECK(pace.mayEdit(1.51));
  pace.took(2, 0.05);
  CHECK_FALSE(pace.mayEdit(2.99));
  CHECK(pace.mayEdit(3.01));

  pace.took(4, 0.001);
  CHECK(pace.mayEdit(4.001));
  pace.took(5, 0.05);
  CHECK(pace.mayEdit(5.51));
}

}  // namespace palpate
