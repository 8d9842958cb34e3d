// Memory in large pages, where the system provides them on request.
#pragma once

#include <cstddef>

namespace palpate {

inline constexpr std::size_t kLargePage = std::size_t{2} << 20;  ///< bytes

/// Requests pages of that size for memory that begins at a multiple of kLargePage: fetching a large array in small
/// pages keeps many threads waiting for the system. The effect is on time alone.
void askForLargePages(void* memory, std::size_t bytes) noexcept;

/// Fetches memory now that is about to be written for the first time, instead of at the first write. From any threads,
/// for disjoint parts: fetching takes longer than writing.
void fetchPages(void* memory, std::size_t bytes) noexcept;

}  // namespace palpate
