#include "engine/core/worker_team.hpp"

#include <doctest/doctest.h>

#include <array>
#include <chrono>
#include <mutex>
#include <new>
#include <set>
#include <thread>

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

TEST_CASE("in a burst the engaged threads take part and no others, before, between and after long pauses") {
  WorkerTeam team(6);
  for (const std::size_t engaged : {1u, 3u, 6u, 9u}) {
    WorkerTeam::Burst burst(team);
    burst.engage(engaged);
    for (int job = 0; job < 4; ++job) {
      std::mutex lock;
      std::set<std::thread::id> threads;
      std::atomic<int> done = 0;
      const auto isFull = [&] {
        const std::scoped_lock hold(lock);
        return threads.size() >= std::min(engaged, team.size());
      };
      team.forEach(200, [&](std::size_t) {
        {
          const std::scoped_lock hold(lock);
          threads.insert(std::this_thread::get_id());
        }
        while (!isFull()) std::this_thread::yield();  // a thread that is not woken would be waited for forever
        std::this_thread::sleep_for(std::chrono::microseconds(50));  // long enough for others to take part
        ++done;
      });
      CHECK(done == 200);
      CHECK(threads.size() == std::min(engaged, team.size()));
      if (job == 1) std::this_thread::sleep_for(std::chrono::milliseconds(3));  // they have fallen asleep
    }
  }
}

TEST_CASE("what a part of a job throws reaches the caller, on whichever thread, and the next job is whole") {
  WorkerTeam team(4);
  for (std::size_t bad = 0; bad < 40; ++bad) {
    CHECK_THROWS_AS(team.forEach(40,
                                 [&](std::size_t part) {
                                   if (part == bad || part == 39) throw std::bad_alloc();
                                 }),
                    std::bad_alloc);
    std::atomic<int> done = 0;
    team.forEach(40, [&](std::size_t) { ++done; });
    CHECK(done == 40);
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
