// The message for a word that is not in a list of names, and its probable meaning.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// The element of `names` nearest to `word`, by the number of letters to insert, delete, replace, or swap with their
/// neighbour; empty if none is near: up to a third of the letters may be wrong.
std::string nearestName(std::string_view word, const std::vector<std::string>& names);

/// "unknown brush 'psuh'; did you mean 'push'?" or "unknown brush 'xyz'". `kind`: "brush".
std::string unknownWord(std::string_view kind, std::string_view word, const std::vector<std::string>& names);

/// The same, with all names: "unknown brush 'psuh'; did you mean 'push'? Choose push, carve".
std::string unknownName(std::string_view kind, std::string_view word, const std::vector<std::string>& names);

/// The same for other ranges of names.
std::string unknownName(std::string_view kind, std::string_view word, const auto& names) {
  return unknownName(kind, word, std::vector<std::string>(std::begin(names), std::end(names)));
}

}  // namespace palpate
