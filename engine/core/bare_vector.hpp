// Arrays whose elements many threads are about to write.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/core/large_pages.hpp"

namespace palpate {

/// Leaves elements that are made without a value as the memory was; large arrays are in large pages.
template <class T>
class BareAllocator {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  using value_type = T;

  BareAllocator() = default;
  template <class U>
  BareAllocator(const BareAllocator<U>&) noexcept {}

  T* allocate(std::size_t count) {
    if (!isLarge(count)) return std::allocator<T>().allocate(count);
    void* memory = ::operator new (count * sizeof(T), std::align_val_t{kLargePage});
    askForLargePages(memory, count * sizeof(T));
    return static_cast<T*>(memory);
  }
  void deallocate(T* values, std::size_t count) noexcept {
    if (isLarge(count))
      ::operator delete (values, std::align_val_t{kLargePage});
    else
      std::allocator<T>().deallocate(values, count);
  }
  bool operator==(const BareAllocator&) const = default;

  template <class U>
  void construct(U*) noexcept {}
  template <class U, class... Values>
  void construct(U* at, Values&&... values) {
    std::construct_at(at, std::forward<Values>(values)...);
  }

 private:
  static constexpr std::size_t kLarge = 4 * kLargePage;  // where a page that is not full is no great loss
  static bool isLarge(std::size_t count) { return count >= kLarge / sizeof(T); }
};

/// As std::vector, but BareVector(count) and resize(count) write nothing, whatever T asks for: to write all of a large
/// array on one thread first, and to fetch its memory from the system on that thread, takes longer than many threads
/// need to fill it. Whoever makes one so writes every element before it is read.
template <class T>
using BareVector = std::vector<T, BareAllocator<T>>;

}  // namespace palpate
