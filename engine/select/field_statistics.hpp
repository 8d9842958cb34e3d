// Statistics of a field.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

struct FieldStatistics {
  static constexpr std::array<double, 7> kPercentiles{1, 5, 25, 50, 75, 95, 99};
  static constexpr std::size_t kBins = 20;

  std::uint64_t count = 0;    ///< values that are numbers; without any, all others are 0
  std::uint64_t missing = 0;  ///< NaN
  double min = 0, max = 0, mean = 0;
  double deviation = 0;                                   ///< standard deviation, of count - 1; 0 for a single value
  std::array<double, kPercentiles.size()> percentiles{};  ///< interpolated between the values next to them
  std::array<std::uint64_t, kBins> histogram{};           ///< values in equal parts of min to max, max in the last one
};
/// Infinite values are in percentiles alone, and make mean and deviation NaN.
FieldStatistics statisticsOf(std::span<const double> values);

/// The values that are numbers, ascending.
std::vector<double> sortedNumbers(std::span<const double> values);
/// The same of sorted numbers.
FieldStatistics statisticsOfSorted(std::span<const double> sorted);
/// Interpolated between the two numbers next to it. `sorted` is not empty.
double percentileOf(std::span<const double> sorted, double percent);

}  // namespace palpate
