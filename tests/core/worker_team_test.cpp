#include "engine/core/worker_team.hpp"

#include <doctest/doctest.h>

#include <array>

namespace palpate::worker_team_test {

TEST_CASE("a worker team executes every part of every job once, with any number of threads") {
  for (const unsigned threads : {1u, 2u, 5u}) {
    WorkerTeam team(threads);
    CHECK(team.size() == threads);
    for (const std::size_t parts : {0u, 1u, 2u, 3u, 100u}) {
      std::array<std::atomic<int>, 100> done{};
      for (int job = 0; job < 20; ++job) team.forEach(parts, [&](std::size_t part) { ++done[part]; });
      for (std::size_t part = 0; part < done.size(); ++part) CHECK(done[part] == (part < parts ? 20 : 0));
    }
  }
}

TEST_CASE("the results of one job are visible to all threads in the next") {
  WorkerTeam team(3);
  std::vector<int> values(1000, 0), next(1000, 0);
  for (int job = 1; job <= 50; ++job) {
    team.forEach(values.size(), [&](std::size_t part) { next[part] = values[(part + 1) % values.size()] + 1; });
    std::swap(values, next);
  }
  for (const int value : values) CHECK(value == 50);
}

}  // namespace palpate::worker_team_test
