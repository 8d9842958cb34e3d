#include <sys/mman.h>

#include "engine/core/large_pages.hpp"

namespace palpate {

void askForLargePages(void* memory, std::size_t bytes) noexcept { ::madvise(memory, bytes, MADV_HUGEPAGE); }

}  // namespace palpate
