// The side to which a stroke has carried a normal, against analytic deformations.
#include "shaders/shared/carried_normal.h"

#include <doctest/doctest.h>

#include <numbers>
#include <random>

#include "engine/core/vec.hpp"
#include "tests/near.hpp"

namespace palpate::carried_normal_test {

namespace {

constexpr double kRadius = 4;
const DVec3 kUp(0, 0, 1);

// A lattice of one spacing in the plane z = 0, moved by `motion`; only points within the radius of the moved origin
// count, as for a refit.
template <class Motion>
double sideOf(const Motion& motion, const DVec3& normal, double extentY = 6) {
  const auto from = shared::carriedFrom(DVec3(0), kUp);
  DVec3 u, v;
  shared::frameAround(normal, u, v);
  shared::CarriedSumsOf<double> sums{};
  const DVec3 center = motion(DVec3(0));
  for (int i = -6; i <= 6; ++i)
    for (int j = -6; j <= 6; ++j) {
      if (std::abs(j) > extentY) continue;
      const DVec3 found(i, j, 0), offset = motion(found) - center;
      if (glm::length(offset) < kRadius) shared::addCarried(sums, from, offset, u, v, found, kUp, kRadius);
    }
  return shared::carriedSide(sums);
}

}  // namespace

TEST_CASE("a rotated and stretched surface carries its normal along, by any angle") {
  for (int degrees = 0; degrees <= 350; degrees += 10) {
    CAPTURE(degrees);
    const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const auto motion = [&](const DVec3& at) { return DVec3(1.5 * c * at.x, 0.7 * at.y, 1.5 * s * at.x) + DVec3(5); };
    const DVec3 truth(-s, 0, c);
    CHECK(sideOf(motion, truth) == near(1, 1e-9));
    CHECK(sideOf(motion, -truth) == near(-1, 1e-9));
    const shared::uint word = shared::packedCarried(Vec3(truth));
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
  CHECK(sideOf(motion, kUp) > -static_cast<double>(shared::kTurnedOver));
  CHECK(sideOf(motion, -kUp) < static_cast<double>(shared::kTurnedOver));
}

TEST_CASE("where neighbours have moved at random the motion determines no side, on the bent wall of a dent neither") {
  // The points of a ring of no width become a cylinder about z: along x, the wall is bent by more than the dent has
  // stretched, and points of any depth stem from any part of the ring.
  constexpr double kDent = 8;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(-1, 1);
  const DVec3 towardsAxis(-1, 0, 0);
  DVec3 u, v;
  shared::frameAround(towardsAxis, u, v);
  const auto from = shared::carriedFrom(DVec3(0), kUp);
  for (int k = 0; k < 20; ++k) {
    shared::CarriedSumsOf<double> sums{};
    for (int i = 0; i < 60; ++i) {
      const double angle = 0.5 * share(random), radius = kDent + 0.05 * share(random),
                   depth = 4 * share(random) - k / 10.0;
      const DVec3 found(radius * std::cos(angle) - kDent, radius * std::sin(angle), 0);
      shared::addCarried(sums, from, DVec3(kDent * (std::cos(angle) - 1), kDent * std::sin(angle), depth), u, v, found,
                         kUp, 2 * kRadius);
    }
    CHECK(std::abs(shared::carriedSide(sums)) < -static_cast<double>(shared::kTurnedOver));
  }
}

TEST_CASE("points on a line, or none, determine no side") {
  CHECK(sideOf([](const DVec3& at) { return DVec3(at.x, 0, 0); }, kUp) == 0);
  CHECK(shared::carriedSide(shared::CarriedSumsOf<double>{}) == 0);
}

TEST_CASE("a neighbour that faced the other way before the stroke does not count") {
  const auto from = shared::carriedFrom(DVec3(0), kUp);
  shared::CarriedSumsOf<double> sums{};
  shared::addCarried(sums, from, DVec3(1, 2, 0), DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(2, 1, 0), -kUp, kRadius);
  CHECK(sums.weight == 0);
  CHECK(sums.products == DVec4(0));
}

}  // namespace palpate::carried_normal_test
