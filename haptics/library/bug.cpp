// What a broken invariant comes to in the library: the call fails, and the host goes on. The program's own definition
// (engine/core/check.cpp) is not linked.
#include "engine/core/check.hpp"
#include "haptics/library/failures.hpp"

namespace palpate {

void stopOnBug(const char* file, int line, const char* what, const std::string& operands) {
  throw library::BugFound("{}:{}: check failed: {}{}; this is a bug of palpate", file, line, what, operands);
}

}  // namespace palpate
