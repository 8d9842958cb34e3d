#include "engine/core/large_pages.hpp"

namespace palpate {

/// Large pages are a privilege there, which people hardly ever have.
void askForLargePages(void*, std::size_t) noexcept {}

void fetchPages(void*, std::size_t) noexcept {}

}  // namespace palpate
