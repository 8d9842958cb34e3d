// Large arrays that other code has as std::vector, which writes zeros into all of it on one thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
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

/// What resize() is going to write, where it does not move what is there: for fetchPages().
template <class T>
std::span<std::byte> freshMemory(std::vector<T>& values, std::size_t count) {
  if (count <= values.size() || count > values.capacity()) return {};
  return {reinterpret_cast<std::byte*>(values.data() + values.size()), (count - values.size()) * sizeof(T)};
}

/// Fetches several such pieces on `threads` (0: one per core), however unequal they are.
inline void fetchTogether(std::span<const std::span<std::byte>> pieces, unsigned threads = 0) {
  constexpr std::size_t kLeast = 4 * kLargePage;  // below that all of it is no matter
  std::vector<std::span<std::byte>> parts;
  for (const std::span<std::byte> piece : pieces)
    for (std::size_t at = 0; piece.size() >= kLeast && at < piece.size(); at += kLargePage)
      parts.push_back(piece.subspan(at, std::min(kLargePage, piece.size() - at)));
  parallelBlocks(parts.size(), 1, threads,
                 [&](std::size_t k, std::size_t) { fetchPages(parts[k].data(), parts[k].size()); });
}

/// As resize(), where all threads fetch the memory from the system, which takes most of the time, before one of them
/// writes the zeros.
template <class T>
void resizeLarge(std::vector<T>& values, std::size_t count, unsigned threads = 0) {
  if (count > values.capacity()) reserveLarge(values, std::max(count, 2 * values.capacity()));
  const std::span<std::byte> fresh = freshMemory(values, count);
  fetchTogether({&fresh, 1}, threads);
  values.resize(count);
}

}  // namespace palpate
