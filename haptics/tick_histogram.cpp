#include "haptics/tick_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

void TickHistogram::add(double time_us) noexcept {
  const double place = kBinsPerOctave * std::log2(std::max(time_us, 1.0));
  ++bins_[place < kBins - 1 ? static_cast<std::size_t>(place) : kBins - 1];  // NaN goes into the last bin
  ++count_;
  if (time_us > max_us_) max_us_ = time_us;
}

double TickHistogram::from_us(std::size_t bin) noexcept {
  return bin == 0 ? 0 : std::exp2(static_cast<double>(bin) / kBinsPerOctave);
}

double TickHistogram::quantile_us(double q) const noexcept {
  const double rank = q * static_cast<double>(count_);
  std::uint64_t below = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    below += bins_[bin];
    if (below > 0 && static_cast<double>(below) >= rank)
      return bin + 1 < kBins ? std::min(from_us(bin + 1), max_us_) : max_us_;
  }
  return 0;
}

}  // namespace palpate
