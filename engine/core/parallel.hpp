// Data parallelism for loading and making clouds. Never used by the servo loop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace palpate {

/// Threads to use when the user asked for `wanted` (0: one per core).
inline unsigned threadCount(unsigned wanted) {
  return wanted ? wanted : std::max(1u, std::thread::hardware_concurrency());
}

/// Calls body(begin, end) on disjoint ranges that cover [0, count). The first exception is thrown again here. The split
/// depends on `threads` only through the range borders, so a body that treats each index alone gives the same result
/// with any number of threads.
template <class Body>
void parallelFor(std::size_t count, unsigned threads, Body&& body) {
  constexpr std::size_t kSmallestRange = 1024;  // below this a thread costs more than it saves
  const std::size_t parts = std::clamp<std::size_t>(count / kSmallestRange, 1, threadCount(threads));
  if (parts == 1) {
    if (count) body(std::size_t{0}, count);
    return;
  }
  std::exception_ptr failure;
  std::mutex failureLock;
  std::vector<std::jthread> workers;
  workers.reserve(parts);
  for (std::size_t part = 0; part < parts; ++part) {
    workers.emplace_back([&, part] {
      try {
        body(count * part / parts, count * (part + 1) / parts);
      } catch (...) {
        const std::scoped_lock hold(failureLock);
        if (!failure) failure = std::current_exception();
      }
    });
  }
  workers.clear();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace palpate
