// Checks for our own bugs: a broken invariant prints the operands and stops the program. In the library, whose host
// program continues, it is an exception (haptics/library/bug.cpp).
#pragma once

#include <fmt/format.h>

namespace palpate {

/// Stops the program. The library replaces the definition in check.cpp by its own.
[[noreturn]] void stopOnBug(const char* file, int line, const char* what, const std::string& operands);

}  // namespace palpate

#define PALPATE_CHECK(condition) ((condition) ? void(0) : ::palpate::stopOnBug(__FILE__, __LINE__, #condition, ""))
#define PALPATE_CHECK_OP(a, op, b)                                                  \
  do {                                                                              \
    const auto& checkLeft = (a);                                                    \
    const auto& checkRight = (b);                                                   \
    if (!(checkLeft op checkRight))                                                 \
      ::palpate::stopOnBug(__FILE__, __LINE__, #a " " #op " " #b,                   \
                           fmt::format(" ({} {} {})", checkLeft, #op, checkRight)); \
  } while (false)
#define PALPATE_CHECK_EQ(a, b) PALPATE_CHECK_OP(a, ==, b)
#define PALPATE_CHECK_LE(a, b) PALPATE_CHECK_OP(a, <=, b)
#define PALPATE_CHECK_LT(a, b) PALPATE_CHECK_OP(a, <, b)
