// The side to which a stroke has carried a normal, against analytic deformations.
#include "shaders/shared/carried_normal.h"

#include <doctest/doctest.h>

#include <numbers>

#include "engine/core/vec.hpp"
#include "tests/near.hpp"

namespace palpate::carried_normal_test {

namespace {

constexpr double kRadius = 4;
const DVec3 kUp(0, 0, 1);

// A lattice of one spacing in the plane z = 0, moved by `motion`; only points within the radius of the moved origin
// count, as for a refit.
template <class Motion>
shared::CarriedTangentsOf<double> tangentsOf(const Motion& motion, double extentY = 6) {
  const auto from = shared::carriedFrom(DVec3(0), kUp);
  shared::CarriedTangentsOf<double> tangents{DVec3(0), DVec3(0)};
  const DVec3 center = motion(DVec3(0));
  for (int i = -6; i <= 6; ++i)
    for (int j = -6; j <= 6; ++j) {
      if (std::abs(j) > extentY) continue;
      const DVec3 found(i, j, 0), offset = motion(found) - center;
      if (glm::length(offset) < kRadius) shared::addCarried(tangents, from, offset, found, kUp, kRadius);
    }
  return tangents;
}

}  // namespace

TEST_CASE("a rotated and stretched surface carries its normal along, by any angle") {
  for (int degrees = 0; degrees <= 350; degrees += 10) {
    CAPTURE(degrees);
    const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const auto motion = [&](const DVec3& at) { return DVec3(1.5 * c * at.x, 0.7 * at.y, 1.5 * s * at.x) + DVec3(5); };
    const DVec3 truth(-s, 0, c);
    const auto tangents = tangentsOf(motion);
    const DVec3 carried = shared::carriedNormal(tangents);
    CHECK(glm::distance(carried, truth) == within(0.0, 1e-12));
    CHECK_FALSE(shared::isAgainst(carried, truth));
    CHECK(shared::isAgainst(carried, -truth));
    const shared::uint word = shared::packedCarried(Vec3(carried));
    CHECK(word != 0);
    CHECK(glm::distance(DVec3(shared::unpackedCarried(word)), truth) == within(0.0, 0.2 * std::numbers::pi / 180));
  }
}

TEST_CASE("at the top of a fold a normal stays outside, where most points around face the other way") {
  // The sheet is bent around a rod of a quarter spacing: both halves are beside each other.
  constexpr double kRod = 0.25;
  const auto motion = [](const DVec3& at) {
    const double bent = std::clamp(at.x / kRod, -std::numbers::pi / 2, std::numbers::pi / 2);
    const double rest = at.x - bent * kRod;
    return DVec3(kRod * std::sin(bent), at.y, kRod * std::cos(bent) - std::abs(rest));
  };
  const auto tangents = tangentsOf(motion);
  CHECK(shared::isAgainst(shared::carriedNormal(tangents), -kUp));
}

TEST_CASE("points on a line, or none, carry a normal nowhere") {
  const auto along = tangentsOf([](const DVec3& at) { return DVec3(at.x, 0, 0); });
  CHECK(shared::carriedNormal(along) == DVec3(0));
  CHECK(shared::carriedNormal(shared::CarriedTangentsOf<double>{DVec3(0), DVec3(0)}) == DVec3(0));
}

TEST_CASE("a neighbour that faced the other way before the stroke does not count") {
  const auto from = shared::carriedFrom(DVec3(0), kUp);
  shared::CarriedTangentsOf<double> tangents{DVec3(0), DVec3(0)};
  shared::addCarried(tangents, from, DVec3(1, 2, 0), DVec3(2, 1, 0), -kUp, kRadius);
  CHECK(tangents.u == DVec3(0));
  CHECK(tangents.v == DVec3(0));
}

}  // namespace palpate::carried_normal_test
