#include "engine/core/page_faults.hpp"

namespace palpate {

/// It counts them together with what was taken away and given back.
std::optional<std::uint64_t> pageFaults() noexcept { return std::nullopt; }

}  // namespace palpate
