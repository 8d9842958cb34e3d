// Pictures of results, drawn by the Python scripts that travel inside the program.
#pragma once

#include <string>

#include "apps/cli/context.hpp"

namespace palpate {

enum class PlotScript {
  bench,  ///< times against points, one line for each way
  touch,  ///< a page of what bench touch found
  edit    ///< an edited step against points, and against those that it touches
};

/// Draws `result` into the PNG `file`. Needs python3 with matplotlib; throws Error without.
void plot(PlotScript script, const Json& result, const std::string& file);

}  // namespace palpate
