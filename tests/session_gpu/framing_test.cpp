#include "haptics/session/framing.hpp"

#include <doctest/doctest.h>

#include "haptics/session/model.hpp"

namespace palpate::framing_test {

TEST_CASE("one looks from above into a room that was scanned from inside, unless backs are to be shown") {
  Model model;
  model.cloud.positions.assign(3, Vec3(0));
  model.cloud.normals.assign(3, Vec3(0, 0, 1));
  for (const bool isInterior : {false, true}) {
    model.upright.isInterior = isInterior;
    CHECK(framingOf(model, UpAxis::z).fromAbove == isInterior);
    for (const std::optional<bool>& chosen : {std::optional<bool>(), std::optional(false), std::optional(true)}) {
      CHECK(frameOptionsOf(model, UpAxis::z, {}, nullptr, {.hidesBacks = chosen}, {}).hidesBacks ==
            chosen.value_or(isInterior));
      CHECK(hiddenBacksNote(model, {.hidesBacks = chosen}).empty() == (chosen || !isInterior));
    }
  }
}

}  // namespace palpate::framing_test
