#include "engine/core/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {

double quantileOfSorted(std::span<const double> sorted, double q) {
  if (sorted.empty()) return 0;
  const double rank = std::ceil(q * static_cast<double>(sorted.size()));
  const auto index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  return sorted[std::min(index, sorted.size() - 1)];
}

Summary summarize(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const double sum = std::accumulate(samples.begin(), samples.end(), 0.0);
  return {.count = samples.size(),
          .min = samples.front(),
          .mean = sum / static_cast<double>(samples.size()),
          .p50 = quantileOfSorted(samples, 0.5),
          .p99 = quantileOfSorted(samples, 0.99),
          .p999 = quantileOfSorted(samples, 0.999),
          .max = samples.back()};
}

}  // namespace palpate
