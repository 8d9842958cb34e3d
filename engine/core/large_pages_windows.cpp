#include "engine/core/large_pages.hpp"

namespace palpate {

/// Large pages require a privilege on Windows that users rarely have.
void askForLargePages(void*, std::size_t) noexcept {}

void fetchPages(void*, std::size_t) noexcept {}

}  // namespace palpate
