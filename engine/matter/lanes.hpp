// SIMD numbers, with which a formula of shaders/shared computes several cells at once.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>

namespace palpate {

/// Four floats, each with bitwise the same results as a float.
class Lanes {
 public:
  static constexpr std::size_t kCount = 4;

  Lanes() = default;
  template <class Number>
  requires std::is_arithmetic_v<Number>
  explicit Lanes(Number all) : values_(Vector{} + static_cast<float>(all)) {}
  explicit Lanes(const std::array<float, kCount>& values) : values_{values[0], values[1], values[2], values[3]} {}

  /// From and to memory.
  static Lanes at(const float* values) {
    Lanes lanes;
    std::memcpy(&lanes.values_, values, sizeof(Vector));
    return lanes;
  }
  void writeTo(float* values) const { std::memcpy(values, &values_, sizeof(Vector)); }

  float operator[](std::size_t lane) const { return values_[lane]; }
  float sum() const { return (values_[0] + values_[1]) + (values_[2] + values_[3]); }

  Lanes operator-() const { return Lanes(-values_); }
  Lanes& operator+=(Lanes b) { return *this = *this + b; }
  Lanes& operator-=(Lanes b) { return *this = *this - b; }
  Lanes& operator*=(Lanes b) { return *this = *this * b; }
  Lanes& operator/=(Lanes b) { return *this = *this / b; }
  /// Selects four of the eight values of `a` and `b`.
  template <int i, int j, int k, int l>
  static Lanes shuffled(Lanes a, Lanes b) {
    return Lanes(__builtin_shufflevector(a.values_, b.values_, i, j, k, l));
  }
  friend Lanes min(Lanes a, Lanes b) { return Lanes(a.values_ < b.values_ ? a.values_ : b.values_); }
  friend Lanes max(Lanes a, Lanes b) { return Lanes(a.values_ > b.values_ ? a.values_ : b.values_); }
  friend Lanes sqrt(Lanes a) {
    Vector roots;
    for (std::size_t k = 0; k < kCount; ++k) roots[k] = std::sqrt(a.values_[k]);
    return Lanes(roots);
  }
  friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.values_ + b.values_); }
  friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.values_ - b.values_); }
  friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.values_ * b.values_); }
  friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.values_ / b.values_); }

 private:
  using Vector [[gnu::vector_size(16)]] = float;
  explicit Lanes(Vector values) : values_(values) {}

  Vector values_;
};

/// Four vectors transposed: one Lanes per component.
struct FourVectors {
  Lanes x, y, z, w;

  static FourVectors of(Lanes a, Lanes b, Lanes c, Lanes d) {
    const auto low = [](Lanes p, Lanes q) { return Lanes::shuffled<0, 4, 1, 5>(p, q); };
    const auto high = [](Lanes p, Lanes q) { return Lanes::shuffled<2, 6, 3, 7>(p, q); };
    const Lanes acLow = low(a, c), acHigh = high(a, c), bdLow = low(b, d), bdHigh = high(b, d);
    return {low(acLow, bdLow), high(acLow, bdLow), low(acHigh, bdHigh), high(acHigh, bdHigh)};
  }
};

}  // namespace palpate

/// Required by glm to accept Lanes as a number.
template <>
class std::numeric_limits<palpate::Lanes> : public std::numeric_limits<float> {};
