#include "engine/cloud/ray_cast.hpp"

#include <doctest/doctest.h>

#include "engine/cloud/counter_random.hpp"
#include "tests/near.hpp"

namespace palpate::ray_cast_test {

TEST_CASE("rays hit a sphere where geometry predicts") {
  const DVec3 center(3, -2, 5);
  const auto sphere = makeShape("sphere", 2, center);
  std::size_t hits = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const DVec3 from = center + DVec3(0, 0, 9);
    const DVec3 to = center + DVec3(3 * randomUnit(1, 2 * i) - 1.5, 3 * randomUnit(1, 2 * i + 1) - 1.5, 0);
    const DVec3 along = 0.1 * (to - from);
    const auto hit = castRay(traced(*sphere), {from, along});
    const double b = glm::dot(along, from - center), a = glm::dot(along, along);
    const double rest = b * b - a * (glm::dot(from - center, from - center) - 1);
    if (std::abs(rest) < 1e-4) continue;
    REQUIRE(hit.has_value() == (rest > 0));
    if (!hit) continue;
    ++hits;
    CHECK(hit->depth == near((-b - std::sqrt(rest)) / a, 1e-6));
    CHECK(glm::distance(hit->normal, from + hit->depth * along - center) < 1e-3);
  }
  CHECK(hits > 100);
}

TEST_CASE("rays hit every shape on its surface, from the side that its normal faces") {
  for (const char* name : {"cube", "torus", "bumpy-sphere"}) {
    CAPTURE(name);
    const auto shape = makeShape(name, 100);
    std::size_t hits = 0;
    for (std::uint64_t i = 0; i < 200; ++i) {
      const DVec3 from(150, 90, 120);
      const DVec3 to(70 * randomUnit(2, 3 * i) - 35, 70 * randomUnit(2, 3 * i + 1) - 35,
                     70 * randomUnit(2, 3 * i + 2) - 35);
      const auto hit = castRay(traced(*shape), {from, to - from});
      if (!hit) continue;
      ++hits;
      CHECK(std::abs(shape->signedDistance(from + hit->depth * (to - from))) < 1e-4);
      CHECK(glm::dot(hit->normal, to - from) < 0);
    }
    CHECK(hits > 60);
  }
}

}  // namespace palpate::ray_cast_test
