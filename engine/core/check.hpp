// Checks for bugs of ours: a broken invariant prints the operands and stops the program.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

namespace palpate {

[[noreturn]] inline void stopOnBug(const char* file, int line, const char* what, const std::string& operands) {
  std::fprintf(stderr, "%s:%d: check failed: %s%s\n", file, line, what, operands.c_str());
  std::abort();
}

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
