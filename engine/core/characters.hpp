#pragma once

#include <string_view>
#include <vector>

namespace palpate {

/// The characters of a text in UTF-8; what is no UTF-8 is U+FFFD, byte by byte.
std::vector<char32_t> charactersOf(std::string_view text);

}  // namespace palpate
