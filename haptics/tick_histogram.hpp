// How long ticks took, counted in bins that grow with the time, without memory or sorting.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate {

/// Four bins to the octave, from 1 us to about 1 s: a quantile is known to 19 %. The first bin also takes what is
/// shorter, the last what is longer or no number.
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
  /// The upper end of the bin in which the `q`-quantile lies (0 to 1), but no more than the longest; 0 when empty.
  double quantile_us(double q) const noexcept;

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  double max_us_ = 0;
};

}  // namespace palpate
