#include "engine/core/unknown_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace palpate {

namespace {

// Damerau 1964, Levenshtein 1966; swapped letters are not edited again.
std::size_t distanceBetween(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> least(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      std::size_t& here = least[i][j];
      if (i == 0 || j == 0) {
        here = i + j;
        continue;
      }
      here = std::min({least[i - 1][j] + 1, least[i][j - 1] + 1, least[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        here = std::min(here, least[i - 2][j - 2] + 1);
    }
  return least[a.size()][b.size()];
}

}  // namespace

std::string nearestName(std::string_view word, const std::vector<std::string>& names) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& name : names)
    if (const std::size_t distance = distanceBetween(word, name); distance < least) {
      least = distance;
      nearest = name;
    }
  return nearest;
}

std::string unknownWord(std::string_view kind, std::string_view word, const std::vector<std::string>& names) {
  const std::string meant = nearestName(word, names);
  return fmt::format("unknown {} '{}'{}", kind, word, meant.empty() ? "" : fmt::format("; did you mean '{}'?", meant));
}

std::string unknownName(std::string_view kind, std::string_view word, const std::vector<std::string>& names) {
  const std::string unknown = unknownWord(kind, word, names);
  return fmt::format("{}{} {}", unknown, unknown.ends_with('?') ? " Choose" : "; choose", fmt::join(names, ", "));
}

}  // namespace palpate
