#include "engine/core/background_task.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

namespace palpate::background_task_test {

TEST_CASE("a background task runs once per start, and its results are visible when it has finished") {
  int runs = 0;
  BackgroundTask task([&] { ++runs; });
  CHECK(task.finishedWithin(0));  // nothing has been started
  for (int i = 1; i <= 100; ++i) {
    task.start();
    CHECK(task.finishedWithin(0));
    CHECK(runs == i);
  }
}

TEST_CASE("waiting for a background task ends with the budget, and its destructor waits for the run") {
  std::atomic<bool> go = false, done = false;
  {
    BackgroundTask task([&] {
      while (!go) std::this_thread::yield();
      done = true;
    });
    task.start();
    CHECK_FALSE(task.finishedWithin(100));
    go = true;
  }
  CHECK(done);
}

TEST_CASE("an exception of a background task is rethrown once, by the wait for it") {
  BackgroundTask task([] { throw std::runtime_error("edit"); });
  task.start();
  CHECK_THROWS_WITH(task.finishedWithin(0), "edit");
  CHECK(task.finishedWithin(0));
}

}  // namespace palpate::background_task_test
