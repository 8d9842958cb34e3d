// Foreign text in messages.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// A piece of foreign text for a message: short, printable, in quotes.
std::string inQuotes(std::string_view text);

}  // namespace palpate
