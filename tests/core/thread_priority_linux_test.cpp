#include "engine/core/thread_priority.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <thread>

#include "engine/core/parallel.hpp"
#include "tests/core/sleeping_thread.hpp"

namespace palpate::thread_priority_test {

namespace {

struct Sleeper : SleepingThread<[] { return ::gettid(); }> {
  int nice() const { return ::getpriority(PRIO_PROCESS, static_cast<id_t>(number())); }
};

}  // namespace

TEST_CASE("threads started later get a lower priority, earlier ones keep theirs") {
  const int usual = ::getpriority(PRIO_PROCESS, 0);
  const Sleeper before;
  const RunningThreads then;
  const Sleeper first, second;
  then.laterOnesGiveWay();
  CHECK(before.nice() == usual);
  CHECK(::getpriority(PRIO_PROCESS, 0) == usual);
  for (const Sleeper* later : {&first, &second}) CHECK(later->nice() > usual);
}

TEST_CASE("a thread that lowers its priority affects no other thread") {
  const int usual = ::getpriority(PRIO_PROCESS, 0);
  std::thread([&] {
    giveWay();
    CHECK(::getpriority(PRIO_PROCESS, 0) > usual);
  }).join();
  CHECK(::getpriority(PRIO_PROCESS, 0) == usual);
}

TEST_CASE("threads of parallel work give way while a thread has deadlines, and not otherwise") {
  const int usual = ::getpriority(PRIO_PROCESS, 0);
  const auto checkNice = [&](bool givesWay) {
    std::array<int, 2> nice{};
    parallelParts(nice.size(), [&](std::size_t part) { nice[part] = ::getpriority(PRIO_PROCESS, 0); });
    for (const int each : nice) CHECK((each > usual) == givesWay);
    CHECK(::getpriority(PRIO_PROCESS, 0) == usual);
  };
  checkNice(false);
  {
    const HasDeadlines first;
    const HasDeadlines second;
    checkNice(true);
  }
  checkNice(false);
}

TEST_CASE("a thread avoids a core for a while, unless it is restricted to that core") {
  const auto allowed = [] {
    cpu_set_t cores;
    REQUIRE(::sched_getaffinity(0, sizeof cores, &cores) == 0);
    return cores;
  };
  const auto checkUsual = [&](const cpu_set_t& usual) {
    const cpu_set_t now = allowed();
    CHECK(CPU_EQUAL(&now, &usual));
  };
  std::thread([&] {
    const cpu_set_t usual = allowed();
    const int core = ::sched_getcpu();
    REQUIRE(core >= 0);
    {
      const AwayFromCore away(core);
      const cpu_set_t now = allowed();
      CHECK(CPU_COUNT(&now) == std::max(1, CPU_COUNT(&usual) - 1));
      if (CPU_COUNT(&usual) > 1) CHECK(::sched_getcpu() != core);
    }
    checkUsual(usual);
    for (const int none : {-1, CPU_SETSIZE, 1'000'000}) {
      const AwayFromCore away(none);
      checkUsual(usual);
    }
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(core), &one);
    REQUIRE(::sched_setaffinity(0, sizeof one, &one) == 0);
    const AwayFromCore away(core);
    checkUsual(one);
  }).join();
}

}  // namespace palpate::thread_priority_test
