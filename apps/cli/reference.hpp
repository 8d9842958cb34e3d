// The reference page: everything that a user can name, from the same tables as the program.
#pragma once

#include <string>

#include "apps/cli/json.hpp"
#include "apps/cli/options.hpp"

namespace palpate {

/// As Markdown, for apps/REFERENCE.md.
std::string referencePage(const Options& program);
/// Options, settings and results as JSON.
Json referenceJson(const Options& program);

}  // namespace palpate
