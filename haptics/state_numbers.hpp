// The state that one tick leaves to the next, as numbers for a session log.
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

/// Counts, writes or reads numbers: a class names its members once, in visitState(), for all three. Allocates nothing;
/// numbers without room are only counted.
class StateNumbers {
 public:
  /// Counts.
  StateNumbers() = default;
  static StateNumbers to(std::span<double> numbers) {
    StateNumbers state;
    state.to_ = numbers;
    return state;
  }
  static StateNumbers from(std::span<const double> numbers) {
    StateNumbers state;
    state.from_ = numbers;
    return state;
  }

  std::size_t count() const { return count_; }
  bool reads() const { return !from_.empty(); }

  template <class... Values>
  void operator()(Values&... values) noexcept {
    (visit(values), ...);
  }

 private:
  template <class T>
  requires std::is_arithmetic_v<T>
  void visit(T& value) noexcept {
    const std::size_t at = count_++;
    if (at < to_.size()) to_[at] = static_cast<double>(value);
    if (at < from_.size()) value = static_cast<T>(from_[at]);
  }
  void visit(DVec3& value) noexcept { (*this)(value.x, value.y, value.z); }
  void visit(DQuat& value) noexcept { (*this)(value.w, value.x, value.y, value.z); }
  template <class T>
  void visit(std::optional<T>& value) noexcept {
    bool isThere = value.has_value();
    T content = value.value_or(T(0));
    (*this)(isThere, content);
    if (reads()) value = isThere ? std::optional(content) : std::nullopt;
  }

  std::span<double> to_;
  std::span<const double> from_;
  std::size_t count_ = 0;
};

}  // namespace palpate
