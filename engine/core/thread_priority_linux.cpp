#include "engine/core/thread_priority.hpp"

#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <filesystem>
#include <string>

namespace palpate {

namespace {

constexpr int kNice = 10;  // of at most 19; gives a tenth of the time of an ordinary thread

// Linux has a nice value for each thread.
void makeNice(std::uint32_t thread) noexcept {
  if (::getpriority(PRIO_PROCESS, thread) < kNice) ::setpriority(PRIO_PROCESS, thread, kNice);
}

// Sorted; empty without /proc.
std::vector<std::uint32_t> runningThreads() {
  std::vector<std::uint32_t> threads;
  std::error_code noProc;
  for (std::filesystem::directory_iterator entry("/proc/self/task", noProc), end; !noProc && entry != end;
       entry.increment(noProc)) {
    const std::string number = entry->path().filename().string();
    std::uint32_t thread = 0;
    if (std::from_chars(number.data(), number.data() + number.size(), thread).ec == std::errc())
      threads.push_back(thread);
  }
  std::ranges::sort(threads);
  return threads;
}

}  // namespace

void giveWay() noexcept { makeNice(0); }

RunningThreads::RunningThreads() : threads_(runningThreads()) {}

void RunningThreads::laterOnesGiveWay() const noexcept {
  try {
    for (const std::uint32_t thread : runningThreads())
      if (!std::ranges::binary_search(threads_, thread)) makeNice(thread);
  } catch (const std::exception&) {  // out of memory: priorities stay
  }
}

AwayFromCore::AwayFromCore(int core) noexcept {
  cpu_set_t others;
  static_assert(sizeof others == sizeof before_);
  if (core < 0 || core >= CPU_SETSIZE || ::sched_getaffinity(0, sizeof others, &others) != 0) return;
  before_ = std::bit_cast<decltype(before_)>(others);
  CPU_CLR(static_cast<std::size_t>(core), &others);
  away_ = CPU_COUNT(&others) > 0 && ::sched_setaffinity(0, sizeof others, &others) == 0;
}

AwayFromCore::~AwayFromCore() {
  if (!away_) return;
  const auto before = std::bit_cast<cpu_set_t>(before_);
  ::sched_setaffinity(0, sizeof before, &before);
}

}  // namespace palpate
