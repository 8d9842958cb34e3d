// Histogram of the durations of ticks in logarithmic bins, without allocation or sorting.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate {

/// Four bins per octave, from 1 us to about 1 s: a quantile is known to 19 %. The first bin also has shorter times, the
/// last one longer times and NaN.
class TickHistogram {
 public:
  static constexpr std::size_t kBins = 80;
  static constexpr double kBinsPerOctave = 4;

  void add(double time_us) noexcept;

  std::uint64_t count() const noexcept { return count_; }
  double max_us() const noexcept { return max_us_; }
  std::uint64_t operator[](std::size_t bin) const noexcept { return bins_[bin]; }

  /// The lower end of a bin, us.
  static double from_us(std::size_t bin) noexcept;
  /// The upper end of the bin of the `q`-quantile (0 to 1), at most the maximum; 0 if empty.
  double quantile_us(double q) const noexcept;

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  double max_us_ = 0;
};

}  // namespace palpate
