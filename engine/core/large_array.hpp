// Large arrays that other code has as std::vector, which writes zeros into all of it on one thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "engine/core/large_pages.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

/// As reserve(), in large pages where there are so many that it matters.
template <class T>
void reserveLarge(std::vector<T>& values, std::size_t count) {
  constexpr std::uintptr_t kMask = kLargePage - 1;
  values.reserve(count);
  const auto begin = reinterpret_cast<std::uintptr_t>(values.data());
  const std::uintptr_t first = (begin + kMask) & ~kMask, end = (begin + values.capacity() * sizeof(T)) & ~kMask;
  if (first + 4 * kLargePage <= end) askForLargePages(reinterpret_cast<void*>(first), end - first);
}

/// Work that any thread may do, whose parts may be done in any order and at the same time.
using Jobs = std::vector<std::function<void()>>;

/// Does the jobs, and calls body(begin, end) on disjoint blocks that cover [0, count), all on `threads` (0: one per
/// core): whoever is free takes the next job, and once all are taken the next block. The first exception is thrown again
/// here.
template <class Body>
void parallelBlocksBeside(const Jobs& jobs, std::size_t count, std::size_t block, unsigned threads, Body&& body) {
  const std::size_t blocks = (count + block - 1) / block;
  parallelBlocks(jobs.size() + blocks, 1, threads, [&](std::size_t k, std::size_t) {
    if (k < jobs.size()) return jobs[k]();
    const std::size_t begin = (k - jobs.size()) * block;
    body(begin, std::min(count, begin + block));
  });
}
inline void doTogether(const Jobs& jobs, unsigned threads) {
  parallelBlocks(jobs.size(), 1, threads, [&](std::size_t k, std::size_t) { jobs[k](); });
}

/// Adds what makes `values` as long as `count`, with zeros behind what is there: to fetch the memory takes most of the
/// time, and is cut up; the zeros come from one thread, an array each. Until the jobs are done, who uses the array uses
/// what was there, from any thread: it does not move, but now, where its room is too small.
template <class T>
void addGrowth(std::vector<T>& values, std::size_t count, Jobs& jobs) {
  constexpr std::size_t kLeast = 4 * kLargePage;  // below that it is no matter where the memory comes from
  if (count <= values.size()) return;
  if (count > values.capacity()) reserveLarge(values, std::max(count, 2 * values.capacity()));
  auto* const fresh = reinterpret_cast<std::byte*>(values.data() + values.size());
  const std::size_t bytes = (count - values.size()) * sizeof(T);
  for (std::size_t at = 0; bytes >= kLeast && at < bytes; at += kLargePage)
    jobs.emplace_back([fresh, at, bytes] { fetchPages(fresh + at, std::min(kLargePage, bytes - at)); });
  jobs.emplace_back([&values, count] { values.resize(count); });
}

/// As resize(), on `threads`.
template <class T>
void resizeLarge(std::vector<T>& values, std::size_t count, unsigned threads = 0) {
  Jobs jobs;
  addGrowth(values, count, jobs);
  doTogether(jobs, threads);
}

/// Makes arrays, which `grow(count, jobs)` adds the growth of, as long as `count`, and calls fill(begin, end) for parts of
/// them on `threads`, while what follows those parts still grows.
template <class Grow, class Fill>
void growAndFill(std::size_t count, unsigned threads, Grow&& grow, Fill&& fill) {
  constexpr std::size_t kFirst = std::size_t{1} << 16, kMost = std::size_t{1} << 22, kBlock = 8192;  // entries
  std::size_t filled = 0, room = 0;
  for (std::size_t next = std::min(count, kFirst); filled < count;) {
    Jobs jobs;
    grow(next, jobs);
    parallelBlocksBeside(jobs, room - filled, kBlock, threads,
                         [&](std::size_t begin, std::size_t end) { fill(filled + begin, filled + end); });
    filled = std::exchange(room, next);
    next = std::min(count, room + std::clamp(2 * (room - filled), kFirst, kMost));
  }
}

}  // namespace palpate
