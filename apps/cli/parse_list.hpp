#pragma once

#include <array>
#include <charconv>
#include <string>

#include "engine/core/error.hpp"

namespace palpate {

/// Parses numbers with a separator between them, to the end of the text. Throws UsageError: `option` is not `wanted`.
template <class T, std::size_t N>
std::array<T, N> parseList(const std::string& text, char separator, const std::string& option,
                           const std::string& wanted) {
  std::array<T, N> values{};
  const char* at = text.data();
  const char* end = at + text.size();
  for (std::size_t i = 0; i < N; ++i) {
    const auto [next, error] = std::from_chars(at, end, values[i]);
    const bool separated = i + 1 == N ? next == end : next != end && *next == separator;
    if (error != std::errc() || !separated) throw UsageError("{}: '{}' is not {}", option, text, wanted);
    at = next + 1;
  }
  return values;
}

}  // namespace palpate
