#include <sys/resource.h>

#include "engine/core/page_faults.hpp"

namespace palpate {

std::optional<std::uint64_t> pageFaults() noexcept {
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(usage.ru_minflt) + static_cast<std::uint64_t>(usage.ru_majflt);
}

}  // namespace palpate
