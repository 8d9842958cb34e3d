#include <windows.h>

#include <limits>

#include "engine/core/free_memory.hpp"

namespace palpate {

std::uint64_t freeMemory_bytes() noexcept {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  return ::GlobalMemoryStatusEx(&status) ? status.ullAvailPhys : std::numeric_limits<std::uint64_t>::max();
}

std::uint64_t freeAddresses_bytes() noexcept { return std::numeric_limits<std::uint64_t>::max(); }

}  // namespace palpate
