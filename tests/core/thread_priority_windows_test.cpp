#include <windows.h>

#include <doctest/doctest.h>

#include <thread>

#include "engine/core/thread_priority.hpp"
#include "tests/core/sleeping_thread.hpp"

namespace palpate::thread_priority_test {

namespace {

struct Sleeper : SleepingThread<[] { return ::GetCurrentThreadId(); }> {
  int priority() const {
    const HANDLE thread = ::OpenThread(THREAD_QUERY_INFORMATION, FALSE, number());
    const int priority = ::GetThreadPriority(thread);
    ::CloseHandle(thread);
    return priority;
  }
};

int ownPriority() { return ::GetThreadPriority(::GetCurrentThread()); }

}  // namespace

TEST_CASE("threads started later get a lower priority, earlier ones keep theirs") {
  const Sleeper before;
  const RunningThreads then;
  const Sleeper first, second;
  then.laterOnesGiveWay();
  CHECK(before.priority() == THREAD_PRIORITY_NORMAL);
  CHECK(ownPriority() == THREAD_PRIORITY_NORMAL);
  for (const Sleeper* later : {&first, &second}) CHECK(later->priority() < THREAD_PRIORITY_NORMAL);
}

TEST_CASE("a thread that lowers its priority affects no other thread") {
  std::thread([] {
    giveWay();
    CHECK(ownPriority() < THREAD_PRIORITY_NORMAL);
  }).join();
  CHECK(ownPriority() == THREAD_PRIORITY_NORMAL);
}

TEST_CASE("a thread avoids a core for a while") {
  DWORD_PTR usual = 0, there = 0;
  REQUIRE(::GetProcessAffinityMask(::GetCurrentProcess(), &usual, &there));
  // Windows returns the affinity of a thread only when it is changed.
  const auto allowed = [&] {
    const DWORD_PTR before = ::SetThreadAffinityMask(::GetCurrentThread(), usual);
    ::SetThreadAffinityMask(::GetCurrentThread(), before);
    return before;
  };
  std::thread([&] {
    {
      const AwayFromCore away(0);
      CHECK(allowed() == (usual == 1 ? usual : usual & ~DWORD_PTR{1}));
    }
    CHECK(allowed() == usual);
    for (const int none : {-1, 64, 1'000'000}) {
      const AwayFromCore away(none);
      CHECK(allowed() == usual);
    }
  }).join();
}

}  // namespace palpate::thread_priority_test
