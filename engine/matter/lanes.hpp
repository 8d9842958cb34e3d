// Several numbers side by side as one, so that a formula of shaders/shared computes as many cells at once.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

namespace palpate {

/// Four floats, each computed as a float is: the same bits.
class Lanes {
 public:
  static constexpr std::size_t kCount = 4;

  Lanes() = default;
  template <class Number>
  requires std::is_arithmetic_v<Number>
  explicit Lanes(Number all) : values_(Vector{} + static_cast<float>(all)) {}
  explicit Lanes(const std::array<float, kCount>& values) : values_{values[0], values[1], values[2], values[3]} {}

  float operator[](std::size_t lane) const { return values_[lane]; }

  Lanes operator-() const { return Lanes(-values_); }
  Lanes& operator+=(Lanes b) { return *this = *this + b; }
  Lanes& operator-=(Lanes b) { return *this = *this - b; }
  Lanes& operator*=(Lanes b) { return *this = *this * b; }
  Lanes& operator/=(Lanes b) { return *this = *this / b; }
  friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.values_ + b.values_); }
  friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.values_ - b.values_); }
  friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.values_ * b.values_); }
  friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.values_ / b.values_); }

 private:
  using Vector [[gnu::vector_size(16)]] = float;
  explicit Lanes(Vector values) : values_(values) {}

  Vector values_;
};

}  // namespace palpate

/// What vectors ask before they take it for a number.
template <>
class std::numeric_limits<palpate::Lanes> : public std::numeric_limits<float> {};
