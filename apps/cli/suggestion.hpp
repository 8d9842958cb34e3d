// The probable meaning of an unknown word on the command line.
#pragma once

#include <string>
#include <vector>

namespace palpate {

/// The element of `names` nearest to `word`, by the number of letters to insert, delete, replace, or swap with their
/// neighbour; empty if none is near: up to a third of the letters may be wrong.
std::string nearestName(const std::string& word, const std::vector<std::string>& names);

}  // namespace palpate
