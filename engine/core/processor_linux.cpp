#include "engine/core/processor.hpp"

#include <sched.h>
#include <unistd.h>

#include <fstream>

namespace palpate {

std::string processorName() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);)
    if (line.starts_with("model name"))
      if (const auto at = line.find(": "); at != std::string::npos) return line.substr(at + 2);
  return "CPU";
}

int coresToUse() noexcept {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  return ::sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : 1;
}

std::uint64_t hostMemory_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  const std::uint64_t all =
      pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) : 0;
  std::uint64_t limit = 0;  // without a limit the file contains a word, or more than the machine's memory
  std::ifstream second("/sys/fs/cgroup/memory.max"), first("/sys/fs/cgroup/memory/memory.limit_in_bytes");
  if (!(second >> limit) && !(first >> limit)) return all;
  return limit > 0 && (all == 0 || limit < all) ? limit : all;
}

int currentCore() noexcept { return ::sched_getcpu(); }

}  // namespace palpate
