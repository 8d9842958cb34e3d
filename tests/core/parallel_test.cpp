#include "engine/core/parallel.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>

#include "engine/core/vec.hpp"
#include "tests/near.hpp"

namespace palpate::parallel_test {

TEST_CASE("a parallel loop visits every index once with any number of threads") {
  for (const std::size_t count : {0u, 1u, 1023u, 1024u, 1025u, 100'003u}) {
    for (const unsigned threads : {0u, 1u, 2u, 7u}) {
      std::vector<std::atomic<int>> visits(count);
      parallelFor(count, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      bool once = true;
      for (const auto& visit : visits) once = once && visit == 1;
      CHECK(once);
    }
  }
}

TEST_CASE("parallel blocks visit every index once and do not exceed the block size") {
  for (const std::size_t count : {0u, 1u, 63u, 64u, 65u, 10'003u}) {
    for (const unsigned threads : {0u, 1u, 2u, 7u}) {
      std::vector<std::atomic<int>> visits(count);
      std::atomic<bool> longer = false;
      parallelBlocks(count, 64, threads, [&](std::size_t begin, std::size_t end) {
        if (end - begin > 64) longer = true;
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      bool once = true;
      for (const auto& visit : visits) once = once && visit == 1;
      CHECK(once);
      CHECK_FALSE(longer);
    }
  }
}

TEST_CASE("an exception in a worker is rethrown in the caller") {
  const auto failing = [](std::size_t begin, std::size_t) {
    if (begin > 0) throw std::runtime_error("worker");
  };
  CHECK_THROWS_WITH(parallelFor(100'000, 4, failing), "worker");
}

TEST_CASE("the frame around any normal is right-handed and orthonormal") {
  for (const DVec3 direction : {DVec3(0, 0, 1), DVec3(0, 0, -1), DVec3(1, 0, 0), DVec3(0.3, -0.4, -0.86602540378)}) {
    const Frame3 frame = frameAround(glm::normalize(direction));
    CHECK(std::abs(glm::dot(frame.u, frame.v)) < 1e-9);
    CHECK(std::abs(glm::dot(frame.u, frame.n)) < 1e-9);
    CHECK(glm::length(frame.u) == near(1, 1e-6));
    CHECK(glm::length(glm::cross(frame.u, frame.v) - frame.n) < 1e-9);
  }
}

TEST_CASE("angles between vectors are accurate from tiny to 180 degrees") {
  CHECK(angleBetween_deg({1, 0, 0}, {1, 1e-9, 0}) == near(5.7295779513e-8, 1e-6));
  CHECK(angleBetween_deg({1, 0, 0}, {0, 2, 0}) == near(90, 1e-6));
  CHECK(angleBetween_deg({1, 0, 0}, {-3, 0, 0}) == near(180, 1e-6));
}

}  // namespace palpate::parallel_test
