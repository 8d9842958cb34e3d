#include "haptics/tick_histogram.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace palpate::tick_histogram_test {

TEST_CASE("every time falls into the bin whose ends enclose it") {
  for (const double time_us : {1.0, 1.1, 2.0, 37.0, 1000.0, 99'999.0, 500'000.0}) {
    TickHistogram histogram;
    histogram.add(time_us);
    std::size_t bin = 0;
    while (histogram[bin] == 0) ++bin;
    CHECK(TickHistogram::from_us(bin) <= time_us);
    CHECK(TickHistogram::from_us(bin + 1) > time_us);
    CHECK(histogram.count() == 1);
    CHECK(histogram.max_us() == time_us);
  }
}

TEST_CASE("times out of range and those that are not numbers are counted at the ends") {
  TickHistogram histogram;
  for (const double time_us : {0.0, -5.0, 0.3}) histogram.add(time_us);
  CHECK(histogram[0] == 3);
  for (const double time_us : {1e12, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    histogram.add(time_us);
  CHECK(histogram[TickHistogram::kBins - 1] == 3);
  CHECK(histogram.count() == 6);
}

TEST_CASE("quantiles are exact to a bin and never beyond the maximum") {
  TickHistogram histogram;
  CHECK(histogram.quantile_us(0.5) == 0);
  for (int i = 1; i <= 1000; ++i) histogram.add(i);
  for (const double q : {0.1, 0.5, 0.99}) {
    CHECK(histogram.quantile_us(q) >= 1000 * q);
    CHECK(histogram.quantile_us(q) <= 1000 * q * 1.19);
  }
  CHECK(histogram.quantile_us(1) == 1000);
}

}  // namespace palpate::tick_histogram_test
