// Data parallelism for loading and generating clouds. Never used by the servo loop.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "engine/core/job_stop.hpp"
#include "engine/core/start_thread.hpp"
#include "engine/core/thread_priority.hpp"

namespace palpate {

/// Threads to use when the user asked for `wanted` (0: one per core).
inline unsigned threadCount(unsigned wanted) {
  return wanted ? wanted : std::max(1u, std::thread::hardware_concurrency());
}

/// Calls body(part) for every part in [0, parts), each on its own thread, which inherits this thread's stop request
/// and gives way to a thread with deadlines. The first exception is rethrown here.
template <class Body>
void parallelParts(std::size_t parts, Body&& body) {
  if (parts == 1) return body(std::size_t{0});
  std::exception_ptr failure;
  std::mutex failureLock;
  std::vector<std::jthread> workers;
  workers.reserve(parts);
  for (std::size_t part = 0; part < parts; ++part) {
    workers.push_back(startThread([&, part, stop = jobStop] {
      const JobStopScope scope(stop);
      if (HasDeadlines::any()) giveWay();
      try {
        body(part);
      } catch (...) {
        const std::scoped_lock hold(failureLock);
        if (!failure) failure = std::current_exception();
      }
    }));
  }
  workers.clear();
  if (failure) std::rethrow_exception(failure);
}

/// Disjoint ranges of about equal length that cover [0, size): one for each thread, fewer where they would be too
/// short.
class ParallelRanges {
 public:
  ParallelRanges(std::size_t size, unsigned threads)
      : size_(size), count_(std::clamp<std::size_t>(size / kSmallest, 1, threadCount(threads))) {}
  /// Number of ranges; at least one, which is empty if the size is 0.
  std::size_t count() const { return count_; }
  std::size_t begin(std::size_t range) const { return size_ * range / count_; }
  std::size_t end(std::size_t range) const { return begin(range + 1); }

 private:
  static constexpr std::size_t kSmallest = 1024;  // below this a thread costs more than it saves
  std::size_t size_, count_;
};

/// Calls body(begin, end) on disjoint ranges that cover [0, count). The first exception is rethrown here. The split
/// depends on `threads` only through the range borders, so a body that treats each index alone gives the same result
/// with any number of threads. Throws Stopped; checks for it after some thousand indices.
template <class Body>
void parallelFor(std::size_t count, unsigned threads, Body&& body) {
  const ParallelRanges ranges(count, threads);
  if (count == 0) return;
  parallelParts(ranges.count(), [&](std::size_t range) {
    constexpr std::size_t kBetweenStops = 4096;
    const std::size_t end = ranges.end(range);
    const std::size_t step = jobStop.mayCut ? kBetweenStops : end - ranges.begin(range);
    for (std::size_t begin = ranges.begin(range); begin < end; begin += step) {
      throwIfStopWanted();
      body(begin, std::min(end, begin + step));
    }
  });
}

/// As parallelFor(), for indices of very different cost: each free thread takes the next `block` of them.
template <class Body>
void parallelBlocks(std::size_t count, std::size_t block, unsigned threads, Body&& body) {
  const std::size_t blocks = (count + block - 1) / block;
  if (count == 0) return;
  std::atomic<std::size_t> next = 0;
  parallelParts(std::min<std::size_t>(blocks, threadCount(threads)), [&](std::size_t) {
    for (std::size_t k; (k = next++) < blocks;) {
      throwIfStopWanted();
      body(k * block, std::min(count, (k + 1) * block));
    }
  });
}

}  // namespace palpate
