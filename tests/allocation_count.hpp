// Counts the allocations of a test program, and makes them fail. Included by one file of a program, since it replaces
// its operator new.
#pragma once

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>
#include <thread>

namespace {

std::atomic<bool> counting = false;
std::atomic<int> allocations = 0;
std::atomic<int> mostAllocations = std::numeric_limits<int>::max();  // further ones fail
std::atomic<std::thread::id> countedThread{};                        // default: all threads

}  // namespace

// Counts only while `counting` is true.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  const std::thread::id only = countedThread;
  if (counting && (only == std::thread::id() || only == std::this_thread::get_id()) && ++allocations > mostAllocations)
    return nullptr;
  return std::malloc(size ? size : 1);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
// Not inlined: g++ 12 would warn about free() on memory from new.
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
