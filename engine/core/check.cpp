// Alone in its file, because the library links another definition instead.
#include "engine/core/check.hpp"

#include <cstdio>
#include <cstdlib>

namespace palpate {

void stopOnBug(const char* file, int line, const char* what, const std::string& operands) {
  std::fprintf(stderr, "%s:%d: check failed: %s%s\n", file, line, what, operands.c_str());
  std::abort();
}

}  // namespace palpate
