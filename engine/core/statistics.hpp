#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpate {

/// The `q`-quantile (0 to 1) by nearest rank; 0 for no samples. `sorted` must be ascending.
double quantileOfSorted(std::span<const double> sorted, double q);

/// The statistics that every measurement reports.
struct Summary {
  std::size_t count = 0;
  double min = 0, mean = 0, p50 = 0, p99 = 0, p999 = 0, max = 0;
};
Summary summarize(std::vector<double> samples);

}  // namespace palpate
