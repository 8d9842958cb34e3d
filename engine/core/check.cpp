// Alone in its file: the library links another definition in its place.
#include "engine/core/check.hpp"

#include <cstdio>
#include <cstdlib>

namespace palpate {

void stopOnBug(const char* file, int line, const char* what, const std::string& operands) {
  std::fprintf(stderr, "%s:%d: check failed: %s%s\n", file, line, what, operands.c_str());
  std::abort();
}

}  // namespace palpate
