// Plots of results, drawn by Python scripts embedded in the program.
#pragma once

#include <string>

#include "apps/cli/context.hpp"

namespace palpate {

enum class PlotScript {
  bench,  ///< times against points, one line for each method
  touch,  ///< a page with the results of bench touch
  edit    ///< an edited step against points in the model, and against touched points
};

/// Draws `result` into the PNG `file`. Requires python3 with matplotlib; throws Error without it.
void plot(PlotScript script, const Json& result, const std::string& file);

}  // namespace palpate
