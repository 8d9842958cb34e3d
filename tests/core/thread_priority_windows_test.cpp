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

TEST_CASE("threads that came later give way, and those that were there do not") {
  const Sleeper before;
  const RunningThreads then;
  const Sleeper first, second;
  then.laterOnesGiveWay();
  CHECK(before.priority() == THREAD_PRIORITY_NORMAL);
  CHECK(ownPriority() == THREAD_PRIORITY_NORMAL);
  for (const Sleeper* later : {&first, &second}) CHECK(later->priority() < THREAD_PRIORITY_NORMAL);
}

TEST_CASE("a thread that gives way does so alone, and for good") {
  std::thread([] {
    giveWay();
    CHECK(ownPriority() < THREAD_PRIORITY_NORMAL);
  }).join();
  CHECK(ownPriority() == THREAD_PRIORITY_NORMAL);
}

TEST_CASE("a thread stays away from a core for a while") {
  DWORD_PTR usual = 0, there = 0;
  REQUIRE(::GetProcessAffinityMask(::GetCurrentProcess(), &usual, &there));
  // To ask for the cores of a thread is to change them.
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
