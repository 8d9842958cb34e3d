// Completions that a shell offers for an incomplete command line.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace palpate {

struct Completions {
  std::vector<std::string> words;
  bool files = true;  ///< a file name is possible, too
};

/// Completions of the last of `words`, which may be incomplete. The words follow the program's name, and may be split
/// at "=" as bash splits them.
Completions completionsOf(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace palpate
