// Completions that a shell offers for an incomplete command line.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/options.hpp"

namespace palpate {

struct Completions {
  std::vector<std::string> words;
  bool files = false;                     ///< a file name is possible, too
  std::vector<std::string> endings = {};  ///< of these files, as in ".csv"; "/": folders alone; empty: any
};

/// Completions of the last of `words`, which may be incomplete. The words follow the program's name, and may be split
/// at "=" and ":" as bash splits them.
Completions completionsOf(const Options& program, const std::vector<std::string>& words);

}  // namespace palpate
