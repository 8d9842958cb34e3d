#include "engine/touch/edit_pace.hpp"

#include <doctest/doctest.h>

namespace palpate {

TEST_CASE("edits in time never rest; a slow one rests as long as it took, the next twice that, and one in time ends it") {
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

  // One hitch, however long, is no more than twice as long.
  pace.took(6, 0.001);
  pace.took(7, 0.4);
  CHECK_FALSE(pace.mayEdit(7.399));
  CHECK(pace.mayEdit(7.401));
}

}  // namespace palpate
