// The results of a bench as tables: the keys and values of its JSON.
#pragma once

#include <cstdio>
#include <string>

#include "apps/cli/context.hpp"
#include "apps/cli/json.hpp"

namespace palpate {

// Plots of results, drawn by Python scripts embedded in the program.
enum class PlotScript {
  bench,  ///< times against points, one line for each method
  touch,  ///< a page with the results of bench touch
  edit    ///< an edited step against points in the model, and against touched points
};

/// Draws `result` into the PNG `file`. Requires python3 with matplotlib; throws Error without it.
void plot(PlotScript script, const Json& result, const std::string& file);

/// Prints each list of objects in `result` as a table with a row for each key and a column for each object, as many of
/// them side by side as fit into 160 characters; the other values as one column. A summary is "p50 / p99.9".
void printTables(std::FILE* out, const std::string& title, const Json& result);

}  // namespace palpate
