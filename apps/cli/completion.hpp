// What a shell offers while a command line is typed.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace palpate {

struct Completions {
  std::vector<std::string> words;
  bool files = true;  ///< whether the name of a file may stand there, too
};

/// What may stand in place of the last of `words`, as far as that is written; they follow the name of the program, and
/// may be split at "=" as bash splits them.
Completions completionsOf(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace palpate
