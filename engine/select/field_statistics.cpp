#include "engine/select/field_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace palpate {

FieldStatistics statisticsOf(std::span<const double> values) {
  const std::vector<double> sorted = sortedNumbers(values);
  FieldStatistics found = statisticsOfSorted(sorted);
  found.missing = values.size() - sorted.size();
  return found;
}

std::vector<double> sortedNumbers(std::span<const double> values) {
  std::vector<double> sorted;
  sorted.reserve(values.size());
  std::ranges::copy_if(values, std::back_inserter(sorted), [](double value) { return !std::isnan(value); });
  std::ranges::sort(sorted);
  return sorted;
}

double percentileOf(std::span<const double> sorted, double percent) {
  const double rank = percent / 100 * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(rank);
  const double share = rank - std::floor(rank), below = sorted[low];
  return share > 0 ? below + share * (sorted[low + 1] - below) : below;
}

FieldStatistics statisticsOfSorted(std::span<const double> sorted) {
  FieldStatistics found;
  found.count = sorted.size();
  if (sorted.empty()) return found;
  const auto count = static_cast<double>(sorted.size());
  found.min = sorted.front(), found.max = sorted.back();
  // About the median, so that large values do not cancel.
  const double middle = sorted[sorted.size() / 2];
  double sum = 0, squares = 0;
  for (const double value : sorted) sum += value - middle;
  found.mean = middle + sum / count;
  for (const double value : sorted) squares += (value - found.mean) * (value - found.mean);
  found.deviation = sorted.size() > 1 ? std::sqrt(squares / (count - 1)) : 0;
  for (std::size_t k = 0; k < found.percentiles.size(); ++k)
    found.percentiles[k] = percentileOf(sorted, FieldStatistics::kPercentiles[k]);
  const double width = (found.max - found.min) / FieldStatistics::kBins;
  for (const double value : sorted) {
    const double bin = width > 0 && std::isfinite(width) ? (value - found.min) / width : 0;
    ++found.histogram[std::min(static_cast<std::size_t>(bin), FieldStatistics::kBins - 1)];
  }
  return found;
}

}  // namespace palpate
