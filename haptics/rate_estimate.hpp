// Rate of change of a value, from samples in steps.
#pragma once

#include <array>
#include <cstddef>

#include "engine/core/vec.hpp"

namespace palpate {

/// A backward difference over the last tick, or over enough ticks to span a millisecond: an encoder step of 55 um looks
/// like 55 mm/s over a millisecond, but like 550 mm/s over a tick of 10 kHz, which a damper would turn into knocks.
class RateEstimate {
 public:
  /// The rate of change per second up to `value`, `dt_s` after the previous one; zero for the first.
  DVec3 add(const DVec3& value, double dt_s) noexcept;

  void reset() noexcept { count_ = 0; }
  template <class Visit>
  void visitState(Visit& visit) noexcept {
    for (Sample& sample : samples_) visit(sample.value, sample.dt_s);
    visit(newest_, count_);
  }

 private:
  static constexpr std::size_t kMax = 16;  // ticks in a difference: a millisecond up to 16 kHz

  struct Sample {
    DVec3 value;
    double dt_s;  ///< since the previous one
  };
  std::array<Sample, kMax + 1> samples_{};
  std::size_t newest_ = 0, count_ = 0;
};

}  // namespace palpate
