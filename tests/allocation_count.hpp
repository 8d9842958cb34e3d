// Counts the allocations of a test program, and makes them fail. allocation_count.cpp, which replaces operator new,
// must be among the program's sources.
#pragma once

#include <atomic>
#include <limits>
#include <thread>

inline std::atomic<bool> counting = false;  // nothing is counted otherwise
inline std::atomic<int> allocations = 0;
inline std::atomic<int> mostAllocations = std::numeric_limits<int>::max();  // further ones fail
inline std::atomic<std::thread::id> countedThread{};                        // default: all threads
