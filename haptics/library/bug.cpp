// In the library a broken invariant fails the call and does not end the host. The program's own definition
// (engine/core/check.cpp) is not linked.
#include "engine/core/check.hpp"
#include "haptics/library/failures.hpp"

namespace palpate {

void stopOnBug(const char* file, int line, const char* what, const std::string& operands) {
  throw library::BugFound("{}:{}: check failed: {}{}; this is a bug of palpate", file, line, what, operands);
}

}  // namespace palpate
