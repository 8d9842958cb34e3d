// Memory in large pages, where the system has them for the asking.
#pragma once

#include <cstddef>

namespace palpate {

inline constexpr std::size_t kLargePage = std::size_t{2} << 20;  ///< bytes

/// Says that memory, which begins at a multiple of kLargePage, is wanted in pages of that size: to fetch a large array
/// in small ones keeps many threads waiting for the system. What the system makes of it shows in nothing but time.
void askForLargePages(void* memory, std::size_t bytes) noexcept;

/// Has the system give memory now that is about to be written for the first time, instead of at that time. From any
/// threads, for parts that differ: to give it takes longer than to write it.
void fetchPages(void* memory, std::size_t bytes) noexcept;

}  // namespace palpate
