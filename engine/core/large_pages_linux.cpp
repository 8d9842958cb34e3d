#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

#include "engine/core/large_pages.hpp"

namespace palpate {

void askForLargePages(void* memory, std::size_t bytes) noexcept { ::madvise(memory, bytes, MADV_HUGEPAGE); }

void fetchPages(void* memory, std::size_t bytes) noexcept {
#ifdef MADV_POPULATE_WRITE  // from Linux 5.14 on; an older kernel refuses, which costs only time
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(memory), first = (begin + page - 1) / page * page;
  const std::uintptr_t end = (begin + bytes) / page * page;
  if (first < end) ::madvise(reinterpret_cast<void*>(first), end - first, MADV_POPULATE_WRITE);
#else
  static_cast<void>(memory), static_cast<void>(bytes);
#endif
}

}  // namespace palpate
