// The waiting of the servo loop alone, and what the kernel took from it meanwhile.
#include "haptics/pace_check.hpp"

#include <doctest/doctest.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "haptics/tick_pacer.hpp"

namespace palpate {

TEST_CASE("every tick comes or is counted as missed, in the time that was asked for") {
  const Stopwatch watch;
  const PaceCheck check = checkPace(500, 0.2);
  CHECK(watch.elapsed_s() >= 0.198);  // the last of them is due then
  CHECK(check.ticks + check.missed == 100);
  CHECK(check.late_us.count() == check.ticks);
  CHECK_THROWS_AS(checkPace(0, 1), UsageError);
  CHECK_THROWS_AS(checkPace(1000, -1), UsageError);
  CHECK_THROWS_AS(checkPace(1000, 1e9), UsageError);
}

TEST_CASE("a session has at least one tick, and no more than memory has rows for") {
  CHECK(plannedTicks(1000, 0) == 1);
  CHECK(plannedTicks(10'000, 60) == 600'000);
  CHECK_THROWS_AS(plannedTicks(1000, std::nan("")), UsageError);
  CHECK_THROWS_AS(plannedTicks(200'000, 1), UsageError);
}

TEST_CASE("a thread whose core goes to another one sees that in its account, and pages that it touches first") {
  const auto spin = [](double for_s) {
    const Stopwatch watch;
    while (watch.elapsed_s() < for_s) {
    }
  };
  cpu_set_t one;
  CPU_ZERO(&one);
  ThreadToll shared;
  std::thread([&] {
    const int core = ::sched_getcpu();
    CPU_SET(core, &one);
    REQUIRE(::pthread_setaffinity_np(::pthread_self(), sizeof one, &one) == 0);
    std::atomic<bool> stop = false;
    std::thread rival([&] {
      while (!stop.load(std::memory_order_relaxed)) {
      }
    });  // it inherits the core
    const ThreadToll before = tollOfThisThread();
    spin(0.3);
    shared = tollOfThisThread() - before;
    stop = true;
    rival.join();
  }).join();
  CHECK(shared.preemptions >= 3);
  if (::access("/proc/thread-self/schedstat", R_OK) == 0)
    CHECK(shared.waited_us > 30'000);  // about half of the time
  else
    MESSAGE("this kernel keeps no account of waiting: not checked");

  constexpr std::size_t kPages = 64, kPage = 4096;
  void* const memory = ::mmap(nullptr, kPages * kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  REQUIRE(memory != MAP_FAILED);
  ::madvise(memory, kPages * kPage, MADV_NOHUGEPAGE);
  const ThreadToll before = tollOfThisThread();
  for (std::size_t i = 0; i < kPages; ++i) static_cast<volatile char*>(memory)[i * kPage] = 1;
  CHECK((tollOfThisThread() - before).pageFaults >= kPages);
  ::munmap(memory, kPages * kPage);
}

}  // namespace palpate
