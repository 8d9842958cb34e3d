#include "haptics/study/spectrum.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "engine/cloud/counter_random.hpp"
#include "tests/near.hpp"

namespace palpate::test::spectrum_test {
namespace {

std::vector<double> tone(double frequency_Hz, double amplitude, std::size_t count, double rate_Hz = 1000) {
  std::vector<double> signal(count);
  for (std::size_t i = 0; i < count; ++i)
    signal[i] = amplitude * std::sin(2 * std::numbers::pi * frequency_Hz * static_cast<double>(i) / rate_Hz + 0.3);
  return signal;
}

}  // namespace

TEST_CASE("a tone has its power at its frequency") {
  for (const std::size_t count : {256u, 1000u, 5000u}) {
    const auto power = welchPower(tone(125, 1, count));
    REQUIRE(power.size() == 129);
    CHECK(std::ranges::max_element(power) - power.begin() == 32);
    CHECK(power[28] < 1e-3 * power[32]);
  }
}

TEST_CASE("two tones share the power as the squares of their amplitudes, across components and lengths") {
  for (const std::size_t count : {200u, 600u, 4000u}) {
    const auto low = tone(20, 2, count), high = tone(200, 1, count);
    std::vector<DVec3> signal(count);
    for (std::size_t i = 0; i < count; ++i) signal[i] = {low[i], 0, high[i]};
    CHECK(powerShare(signal, 1000, 50, 500) == near(0.2, 0.02));
    CHECK(powerShare(signal, 1000, 0, 50) == near(0.8, 0.02));
    CHECK(powerShare(signal, 2000, 300, 500) == near(0.2, 0.02));  // 400 Hz at that rate
  }
}

TEST_CASE("white noise has the same power at all frequencies") {
  std::vector<DVec3> noise(40'000);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = randomNormal3(9, i);
  CHECK(powerShare(noise, 1000, 50, 500) == near(0.9, 0.01));
  CHECK(powerShare(noise, 1000, 100, 200) == near(0.2, 0.05));
}

TEST_CASE("a constant has no power at any frequency, and no signal has no power") {
  const std::vector<DVec3> constant(300, DVec3(1, 2, 3));
  CHECK(powerShare(constant, 1000, 50, 500) < 1e-6);
  CHECK(powerShare(std::vector<DVec3>(300, DVec3(0)), 1000, 0, 500) == 0);
  CHECK(powerShare({}, 1000, 0, 500) == 0);
  CHECK(welchPower(std::vector<double>{1}).empty());
}

}  // namespace palpate::test::spectrum_test
