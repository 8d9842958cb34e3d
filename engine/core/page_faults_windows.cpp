#include "engine/core/page_faults.hpp"

namespace palpate {

/// Windows counts first accesses together with pages that were evicted and restored.
std::optional<std::uint64_t> pageFaults() noexcept { return std::nullopt; }

}  // namespace palpate
