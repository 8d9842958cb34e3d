// How often the system had to fetch memory for this process.
#pragma once

#include <cstdint>
#include <optional>

namespace palpate {

/// Pages, small or large, that were fetched one at a time at their first access, since the process began; empty if the
/// system does not count them.
std::optional<std::uint64_t> pageFaults() noexcept;

}  // namespace palpate
