// The results of a bench as tables: the keys and values of its JSON.
#pragma once

#include <cstdio>
#include <string>

#include "apps/cli/json.hpp"

namespace palpate {

/// Prints each list of objects in `result` as a table with a row for each key and a column for each object, as many of
/// them side by side as fit into 160 characters; the other values as one column. A summary is "p50 / p99.9".
void printTables(std::FILE* out, const std::string& title, const Json& result);

}  // namespace palpate
