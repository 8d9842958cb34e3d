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

/// Calls body(part) for every part in [0, parts), each on a thread of its own; the first exception is thrown again here.
template <class Body>
void parallelParts(std::size_t parts, Body&& body) {
  if (parts == 1) return body(std::size_t{0});
  std::exception_ptr failure;
  std::mutex failureLock;
  std::vector<std::jthread> workers;
  workers.reserve(parts);
  for (std::size_t part = 0; part < parts; ++part) {
    workers.emplace_back([&, part] {
      try {
        body(part);
      } catch (...) {
        const std::scoped_lock hold(failureLock);
        if (!failure) failure = std::current_exception();
      }
    });
  }
  workers.clear();
  if (failure) std::rethrow_exception(failure);
}

/// Calls body(begin, end) on disjoint ranges that cover [0, count). The first exception is thrown again here. The split
/// depends on `threads` only through the range borders, so a body that treats each index alone gives the same result
/// with any number of threads.
template <class Body>
void parallelFor(std::size_t count, unsigned threads, Body&& body) {
  constexpr std::size_t kSmallestRange = 1024;  // below this a thread costs more than it saves
  const std::size_t parts = std::clamp<std::size_t>(count / kSmallestRange, 1, threadCount(threads));
  if (count == 0) return;
  parallelParts(parts, [&](std::size_t part) { body(count * part / parts, count * (part + 1) / parts); });
}

}  // namespace palpate
