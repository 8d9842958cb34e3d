// Arrays whose elements are about to be written by many threads.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/core/large_pages.hpp"

namespace palpate {

/// Leaves default-constructed elements uninitialised; large arrays use large pages.
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
  static constexpr std::size_t kLarge = 4 * kLargePage;  // above this a partly used large page is an acceptable loss
  static bool isLarge(std::size_t count) { return count >= kLarge / sizeof(T); }
};

/// As std::vector, but BareVector(count) and resize(count) initialise nothing, for any T. Initialising a large
/// array and allocating its pages on one thread takes longer than filling it with many threads. The caller writes every
/// element before it is read.
template <class T>
using BareVector = std::vector<T, BareAllocator<T>>;

}  // namespace palpate
