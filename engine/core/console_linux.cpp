#include <unistd.h>

#include "engine/core/console.hpp"

namespace palpate {

bool isErrorConsole() noexcept { return ::isatty(STDERR_FILENO) != 0; }

}  // namespace palpate
