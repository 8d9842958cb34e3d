// Foreign text in messages.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// Foreign text for a message: truncated, printable, in quotes; bytes that are not text are not shown.
std::string inQuotes(std::string_view text);

}  // namespace palpate
