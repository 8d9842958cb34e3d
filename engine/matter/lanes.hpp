// SIMD numbers, with which a formula of shaders/shared computes several cells at once.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>

namespace palpate {

template <std::size_t N>
struct VectorOf;
template <>
struct VectorOf<4> {
  using Type [[gnu::vector_size(16)]] = float;
};
template <>
struct VectorOf<8> {
  using Type [[gnu::vector_size(32)]] = float;
};

/// `N` floats, each with bitwise the same results as a float.
template <std::size_t N>
class LanesOf {
 public:
  static constexpr std::size_t kCount = N;

  LanesOf() = default;
  template <class Number>
  requires std::is_arithmetic_v<Number>
  explicit LanesOf(Number all) : values_(Vector{} + static_cast<float>(all)) {}
  explicit LanesOf(const std::array<float, kCount>& values) { std::memcpy(&values_, values.data(), sizeof(Vector)); }

  /// From and to memory.
  static LanesOf at(const float* values) {
    LanesOf lanes;
    std::memcpy(&lanes.values_, values, sizeof(Vector));
    return lanes;
  }
  void writeTo(float* values) const { std::memcpy(values, &values_, sizeof(Vector)); }

  float operator[](std::size_t lane) const { return values_[lane]; }
  float sum() const requires(N == 4) { return (values_[0] + values_[1]) + (values_[2] + values_[3]); }

  LanesOf operator-() const { return LanesOf(-values_); }
  LanesOf& operator+=(LanesOf b) { return *this = *this + b; }
  LanesOf& operator-=(LanesOf b) { return *this = *this - b; }
  LanesOf& operator*=(LanesOf b) { return *this = *this * b; }
  LanesOf& operator/=(LanesOf b) { return *this = *this / b; }
  /// Selects as many of the values of `a` and `b`.
  template <int... chosen>
  static LanesOf shuffled(LanesOf a, LanesOf b) {
    return LanesOf(__builtin_shufflevector(a.values_, b.values_, chosen...));
  }

  /// From two halves, and back.
  static LanesOf of(LanesOf<N / 2> low, LanesOf<N / 2> high) {
    return LanesOf(__builtin_shufflevector(low.values_, high.values_, 0, 1, 2, 3, 4, 5, 6, 7));
  }
  LanesOf<N / 2> low() const { return LanesOf<N / 2>(__builtin_shufflevector(values_, values_, 0, 1, 2, 3)); }
  LanesOf<N / 2> high() const { return LanesOf<N / 2>(__builtin_shufflevector(values_, values_, 4, 5, 6, 7)); }
  friend LanesOf min(LanesOf a, LanesOf b) { return LanesOf(a.values_ < b.values_ ? a.values_ : b.values_); }
  friend LanesOf max(LanesOf a, LanesOf b) { return LanesOf(a.values_ > b.values_ ? a.values_ : b.values_); }
  friend LanesOf sqrt(LanesOf a) {
    Vector roots;
    for (std::size_t k = 0; k < kCount; ++k) roots[k] = std::sqrt(a.values_[k]);
    return LanesOf(roots);
  }
  friend LanesOf operator+(LanesOf a, LanesOf b) { return LanesOf(a.values_ + b.values_); }
  friend LanesOf operator-(LanesOf a, LanesOf b) { return LanesOf(a.values_ - b.values_); }
  friend LanesOf operator*(LanesOf a, LanesOf b) { return LanesOf(a.values_ * b.values_); }
  friend LanesOf operator/(LanesOf a, LanesOf b) { return LanesOf(a.values_ / b.values_); }

 private:
  template <std::size_t>
  friend class LanesOf;
  using Vector = typename VectorOf<N>::Type;
  explicit LanesOf(const Vector& values) : values_(values) {}

  Vector values_;
};

using Lanes = LanesOf<4>;

/// Sum of many floats, as eight sums of every eighth one: the same bits for any `N` lanes that form it.
template <std::size_t N>
class LaneSum {
 public:
  static constexpr std::size_t kParts = 8 / N;

  /// The next eight floats consist of kParts parts; one that is omitted counts as zeros.
  void add(std::size_t part, LanesOf<N> values) { parts_[part] += values; }
  float total() const {
    if constexpr (N == 8)
      return (parts_[0].low() + parts_[0].high()).sum();
    else
      return (parts_[0] + parts_[1]).sum();
  }

 private:
  static std::array<LanesOf<N>, kParts> zeros() {
    std::array<LanesOf<N>, kParts> zeros;
    zeros.fill(LanesOf<N>(0));
    return zeros;
  }

  std::array<LanesOf<N>, kParts> parts_ = zeros();
};

/// `N` vectors transposed: lanes for each component.
template <std::size_t N>
struct VectorsOf {
  LanesOf<N> x, y, z, w;

  static VectorsOf of(const std::array<Lanes, N>& all) {
    if constexpr (N == 4) {
      return transposed(all[0], all[1], all[2], all[3]);
    } else {
      const auto both = [&](std::size_t k) { return LanesOf<N>::of(all[k], all[k + 4]); };
      return transposed(both(0), both(1), both(2), both(3));
    }
  }

  /// The vectors again.
  std::array<Lanes, N> each() const {
    const VectorsOf by = transposed(x, y, z, w);
    if constexpr (N == 4)
      return {by.x, by.y, by.z, by.w};
    else
      return {by.x.low(), by.y.low(), by.z.low(), by.w.low(), by.x.high(), by.y.high(), by.z.high(), by.w.high()};
  }

 private:
  static VectorsOf transposed(LanesOf<N> a, LanesOf<N> b, LanesOf<N> c, LanesOf<N> d) {
    const LanesOf<N> acLow = low(a, c), acHigh = high(a, c), bdLow = low(b, d), bdHigh = high(b, d);
    return {low(acLow, bdLow), high(acLow, bdLow), low(acHigh, bdHigh), high(acHigh, bdHigh)};
  }
  // The first, or last, two of each four lanes of both, alternating.
  static LanesOf<N> low(LanesOf<N> p, LanesOf<N> q) {
    if constexpr (N == 4)
      return LanesOf<N>::template shuffled<0, 4, 1, 5>(p, q);
    else
      return LanesOf<N>::template shuffled<0, 8, 1, 9, 4, 12, 5, 13>(p, q);
  }
  static LanesOf<N> high(LanesOf<N> p, LanesOf<N> q) {
    if constexpr (N == 4)
      return LanesOf<N>::template shuffled<2, 6, 3, 7>(p, q);
    else
      return LanesOf<N>::template shuffled<2, 10, 3, 11, 6, 14, 7, 15>(p, q);
  }
};

}  // namespace palpate

/// Required by glm to accept them as numbers.
template <std::size_t N>
class std::numeric_limits<palpate::LanesOf<N>> : public std::numeric_limits<float> {};
