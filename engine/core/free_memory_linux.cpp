#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "engine/core/free_memory.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kKiB = 1024;

// The number behind a name in a file of such lines; the first number of the file for an empty name.
std::optional<std::uint64_t> numberIn(const char* file, const std::string& name = "") {
  std::ifstream in(file);
  std::string word;
  std::uint64_t number = 0;
  if (name.empty()) return in >> number ? std::optional(number) : std::nullopt;
  while (in >> word)
    if (word == name) return in >> number ? std::optional(number) : std::nullopt;
  return std::nullopt;
}

// Of a container; files in the cache are given back when memory is needed.
std::optional<std::uint64_t> freeIn(const char* limit, const char* usage, const char* statistics) {
  const auto most = numberIn(limit), used = numberIn(usage);
  if (!most || !used) return std::nullopt;
  const std::uint64_t held = *used - std::min(*used, numberIn(statistics, "inactive_file").value_or(0));
  return *most - std::min(*most, held);
}

}  // namespace

std::uint64_t freeAddresses_bytes() noexcept {
  try {
    rlimit limit{};
    const auto pages = numberIn("/proc/self/statm");
    if (pages && ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
      const std::uint64_t taken = *pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
      return limit.rlim_cur - std::min<std::uint64_t>(limit.rlim_cur, taken);
    }
  } catch (...) {  // unknown: nothing is refused
  }
  return std::numeric_limits<std::uint64_t>::max();
}

std::uint64_t freeMemory_bytes() noexcept {
  std::uint64_t free = freeAddresses_bytes();
  try {
    if (const auto available = numberIn("/proc/meminfo", "MemAvailable:")) free = std::min(free, *available * kKiB);
    for (const auto& container :
         {freeIn("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current", "/sys/fs/cgroup/memory.stat"),
          freeIn("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes",
                 "/sys/fs/cgroup/memory/memory.stat")})
      free = std::min(free, container.value_or(free));
  } catch (...) {  // unknown: nothing is refused
  }
  return free;
}

}  // namespace palpate
