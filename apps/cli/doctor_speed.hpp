// What `palpate doctor --speed` measures.
#pragma once

#include <cstdio>

#include "apps/cli/context.hpp"

namespace palpate {

/// Measures for at most three seconds, longer on a busy machine, and prints as a table: the ticks that a servo loop
/// reaches, and a tick with an edit of a million points on the CPU and on a GPU other than a software driver.
Json machineSpeed(std::FILE* out, Context& context);

}  // namespace palpate
