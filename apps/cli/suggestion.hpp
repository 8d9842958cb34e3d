// What was probably meant by a word on the command line that nothing is called.
#pragma once

#include <string>
#include <vector>

namespace palpate {

/// The one of `names` that is nearest to `word`, by how many letters have to be put in, left out, replaced, or swapped
/// with their neighbour; empty where none is near: a third of its letters may be wrong.
std::string nearestName(const std::string& word, const std::vector<std::string>& names);

}  // namespace palpate
