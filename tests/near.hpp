// Comparisons with an explicit tolerance. doctest's own accepts epsilon * (1 + |value|): below 1, a relative error
// becomes an absolute one, and 0 passes for 0.005 "within 5 %".
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#ifdef _WIN32
#include <windows.h>  // included first, because it defines `near` as an empty macro
#undef near
#undef far
#endif

namespace palpate {

/// A value and its accepted error, bounds included; made by near() and within(). NaN equals nothing.
struct Expected {
  double value, error;

  template <typename T>
  requires std::is_arithmetic_v<T>
  friend bool operator==(T actual, const Expected& expected) {
    return std::abs(static_cast<double>(actual) - expected.value) <= expected.error;
  }
};

/// CHECK(x == within(5.0, 0.1)): |x - 5.0| <= 0.1.
inline Expected within(double value, double absolute) {
  if (std::isinf(value)) throw std::invalid_argument("within: the value is infinite");
  if (!(absolute >= 0 && std::isfinite(absolute)))
    throw std::invalid_argument("within: the tolerance must be finite and not negative");
  return {value, absolute};
}

/// CHECK(x == near(5.0, 0.02)): |x - 5.0| <= 0.02 * 5.0. A relative tolerance of 1 would accept 0.
inline Expected near(double value, double relative) {
  if (value == 0) throw std::invalid_argument("near: 0 has no relative tolerance; use within");
  if (!(relative >= 0 && relative < 1)) throw std::invalid_argument("near: the share must be at least 0 and below 1");
  return within(value, relative * std::abs(value));
}

}  // namespace palpate

template <>
struct doctest::StringMaker<palpate::Expected> {
  static String convert(const palpate::Expected& expected) {
    std::ostringstream out;
    out.precision(10);
    out << expected.value << " +- " << expected.error;
    return out.str().c_str();
  }
};
