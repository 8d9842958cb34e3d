// The kernel's statistics of a preempted thread.
#include "haptics/scheduling_statistics.hpp"

#include <doctest/doctest.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "engine/core/clock.hpp"

namespace palpate::scheduling_statistics_test {

TEST_CASE("a preempted thread sees its waiting time and its page faults in the statistics") {
  cpu_set_t one;
  CPU_ZERO(&one);
  SchedulingStatistics shared;
  constexpr double kWaited_us = 30'000;
  const bool isCounted = ::access("/proc/thread-self/schedstat", R_OK) == 0;
  std::thread([&] {
    const int core = ::sched_getcpu();
    CPU_SET(core, &one);
    REQUIRE(::pthread_setaffinity_np(::pthread_self(), sizeof one, &one) == 0);
    std::atomic<bool> stop = false;
    std::thread rival([&] {
      while (!stop.load(std::memory_order_relaxed)) {
      }
    });  // inherits the core
    const SchedulingStatistics before = schedulingOfThisThread();
    // A busy machine may give the core to others for long, so that the measurement has no fixed duration.
    for (const Stopwatch watch; watch.elapsed_s() < 20;) {
      shared = schedulingOfThisThread() - before;
      if (shared.preemptions >= 3 && (!isCounted || shared.waited_us > kWaited_us)) break;
    }
    stop = true;
    rival.join();
  }).join();
  CHECK(shared.preemptions >= 3);
  if (isCounted)
    CHECK(shared.waited_us > kWaited_us);
  else
    MESSAGE("skipped: this kernel counts no waiting times (schedstat)");

  constexpr std::size_t kPages = 64, kPage = 4096;
  void* const memory = ::mmap(nullptr, kPages * kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  REQUIRE(memory != MAP_FAILED);
  ::madvise(memory, kPages * kPage, MADV_NOHUGEPAGE);
  const SchedulingStatistics before = schedulingOfThisThread();
  for (std::size_t i = 0; i < kPages; ++i) static_cast<volatile char*>(memory)[i * kPage] = 1;
  CHECK((schedulingOfThisThread() - before).pageFaults >= kPages);
  ::munmap(memory, kPages * kPage);
}

}  // namespace palpate::scheduling_statistics_test
