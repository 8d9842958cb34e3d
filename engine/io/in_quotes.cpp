#include "engine/io/in_quotes.hpp"

#include <algorithm>

#include "engine/core/characters.hpp"

namespace palpate {

namespace {

/// Text of any encoding has no control characters; in single bytes some letters are not valid UTF-8.
bool isText(std::string_view text) {
  constexpr double kMaxInvalid = 0.25;
  const std::vector<char32_t> characters = charactersOf(text);
  const auto invalid = std::ranges::count(characters, U'\uFFFD');
  return static_cast<double>(invalid) <= kMaxInvalid * static_cast<double>(characters.size()) &&
         std::ranges::none_of(characters, [](char32_t c) { return (c < U' ' && c != U'\t') || c == 0x7f; });
}

}  // namespace

std::string inQuotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  if (!isText(text.substr(0, kLongest))) return "bytes that are not text";
  std::string out = "'";
  for (const char c : text.substr(0, kLongest)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace palpate
