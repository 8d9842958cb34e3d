#include "engine/core/characters.hpp"

namespace palpate {

std::vector<char32_t> charactersOf(std::string_view text) {
  constexpr char32_t kUnknown = 0xfffd;
  std::vector<char32_t> characters;
  characters.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t bytes = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    char32_t character = bytes == 1 ? first : first & (0x7fu >> bytes);
    bool right = bytes > 0 && i + bytes <= text.size();
    for (std::size_t k = 1; right && k < bytes; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      right = next >> 6 == 2;
      character = character << 6 | (next & 0x3fu);
    }
    characters.push_back(right ? character : kUnknown);
    i += right ? bytes : 1;
  }
  return characters;
}

}  // namespace palpate
