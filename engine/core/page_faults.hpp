// How often the system had to fetch memory for this process.
#pragma once

#include <cstdint>
#include <optional>

namespace palpate {

/// Pages, small or large, that were fetched one at a time when they were touched first, since the process began;
/// nothing where the system does not count them.
std::optional<std::uint64_t> pageFaults() noexcept;

}  // namespace palpate
