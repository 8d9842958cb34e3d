// Foreign text in messages.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// Foreign text for a message: truncated, printable, in quotes.
std::string inQuotes(std::string_view text);

}  // namespace palpate
