#pragma once

#include <string_view>
#include <vector>

namespace palpate {

/// The characters of a UTF-8 text; each byte that is not valid UTF-8 becomes U+FFFD.
std::vector<char32_t> charactersOf(std::string_view text);

}  // namespace palpate
