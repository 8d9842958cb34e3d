// Memory that a test program holds from operator new, with a bound. Included by one file of a program, since it
// replaces operator new.
#pragma once

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>

namespace palpate::test {

/// Bytes of all threads together.
struct MemoryUse {
  static constexpr std::int64_t kNoBound = std::numeric_limits<std::int64_t>::max();
  static inline std::atomic<std::int64_t> now = 0, most = 0, bound = kNoBound;
  static inline std::atomic<bool> refused = false;  ///< an allocation exceeded the bound

  static bool add(std::int64_t bytes) {
    const std::int64_t sum = now += bytes;
    if (sum > bound) {
      now -= bytes;
      refused = true;
      return false;
    }
    for (std::int64_t old = most; old < sum && !most.compare_exchange_weak(old, sum);) {
    }
    return true;
  }
};

/// During its lifetime operator new gives at most `bytes` more than before, and throws bad_alloc beyond.
class MemoryBound {
 public:
  explicit MemoryBound(std::int64_t bytes) : before_(MemoryUse::now) {
    MemoryUse::most = before_;
    MemoryUse::refused = false;
    MemoryUse::bound = before_ + bytes;
  }
  ~MemoryBound() { MemoryUse::bound = MemoryUse::kNoBound; }
  MemoryBound(const MemoryBound&) = delete;
  MemoryBound& operator=(const MemoryBound&) = delete;

  static bool isBroken() { return MemoryUse::refused; }
  std::int64_t most() const { return MemoryUse::most - before_; }

 private:
  std::int64_t before_;
};

inline std::int64_t bytesAt(void* memory) {
#ifdef _WIN32
  return static_cast<std::int64_t>(_msize(memory));
#else
  return static_cast<std::int64_t>(malloc_usable_size(memory));
#endif
}

}  // namespace palpate::test

void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  using palpate::test::MemoryUse;
  // Checked before the allocation, so that an excessive size is never requested.
  constexpr auto kMax = static_cast<std::size_t>(MemoryUse::kNoBound / 2);
  if (const std::int64_t bound = MemoryUse::bound;
      bound != MemoryUse::kNoBound && MemoryUse::now + static_cast<std::int64_t>(std::min(size, kMax)) > bound) {
    MemoryUse::refused = true;
    return nullptr;
  }
  void* memory = std::malloc(size ? size : 1);
  if (memory && !MemoryUse::add(palpate::test::bytesAt(memory))) {
    std::free(memory);
    return nullptr;
  }
  return memory;
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
// Not inlined: g++ 12 would warn about free() of memory from new.
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  if (!memory) return;
  palpate::test::MemoryUse::now -= palpate::test::bytesAt(memory);
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }
