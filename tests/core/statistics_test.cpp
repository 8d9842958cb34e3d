#include "engine/core/statistics.hpp"

#include <doctest/doctest.h>

#include "tests/near.hpp"

namespace palpate::statistics_test {

TEST_CASE("quantiles are nearest-rank samples") {
  std::vector<double> samples;
  for (int i = 1000; i >= 1; --i) samples.push_back(i);
  const Summary summary = summarize(samples);
  CHECK(summary.count == 1000);
  CHECK(summary.min == 1);
  CHECK(summary.p50 == 500);
  CHECK(summary.p99 == 990);
  CHECK(summary.p999 == 999);
  CHECK(summary.max == 1000);
  CHECK(summary.mean == near(500.5, 1e-6));
}

TEST_CASE("empty and single samples have a summary too") {
  CHECK(summarize({}).count == 0);
  CHECK(summarize({}).p999 == 0);
  CHECK(summarize({7}).p50 == 7);
  CHECK(summarize({7}).p999 == 7);
}

}  // namespace palpate::statistics_test
