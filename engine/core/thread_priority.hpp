#pragma once

#include <string_view>

namespace palpate {

/// The calling thread gives way to those that cannot wait: it and the threads that it starts get less time where cores
/// are short, and are put aside at once when others wake up. For good: an ordinary user cannot take it back.
void giveWay() noexcept;

/// The same for all threads of this program whose names begin so.
void letThreadsGiveWay(std::string_view names) noexcept;

}  // namespace palpate
