#include "haptics/study/spectrum.hpp"

#include <algorithm>
#include <bit>
#include <complex>
#include <numbers>

namespace palpate {
namespace {

// In place, decimation in time; the size is a power of two (Cooley and Tukey 1965).
void fourierTransform(std::vector<std::complex<double>>& values) {
  const std::size_t size = values.size();
  for (std::size_t i = 1, reversed = 0; i < size; ++i) {
    std::size_t bit = size >> 1;
    for (; reversed & bit; bit >>= 1) reversed ^= bit;
    reversed ^= bit;
    if (i < reversed) std::swap(values[i], values[reversed]);
  }
  for (std::size_t span = 2; span <= size; span *= 2)
    for (std::size_t k = 0; k < span / 2; ++k) {
      const auto turn = std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(span));
      for (std::size_t begin = k; begin < size; begin += span) {
        const auto odd = turn * values[begin + span / 2];
        values[begin + span / 2] = values[begin] - odd;
        values[begin] += odd;
      }
    }
}

}  // namespace

std::vector<double> welchPower(std::span<const double> signal, std::size_t segment) {
  segment = std::min(segment, signal.size());
  if (segment < 2) return {};
  const std::size_t size = std::bit_ceil(segment);  // zero-padded, which only adds frequencies in between
  std::vector<double> power(size / 2 + 1, 0.0);
  std::vector<std::complex<double>> values(size);
  for (std::size_t begin = 0; begin + segment <= signal.size(); begin += (segment + 1) / 2) {
    std::ranges::fill(values, 0.0);
    for (std::size_t i = 0; i < segment; ++i) {
      const double phase = 2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(segment);
      values[i] = signal[begin + i] * 0.5 * (1 - std::cos(phase));
    }
    fourierTransform(values);
    // The frequencies between zero and half the rate represent their mirror images, too.
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += (k == 0 || k == size / 2 ? 1 : 2) * std::norm(values[k]);
  }
  return power;
}

double powerShare(std::span<const DVec3> signal, double rate_Hz, double from_Hz, double to_Hz) {
  double all = 0, between = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> component(signal.size());
    std::ranges::transform(signal, component.begin(), [&](const DVec3& v) { return v[axis]; });
    const auto power = welchPower(component);
    for (std::size_t k = 0; k < power.size(); ++k) {
      const double frequency_Hz = rate_Hz * static_cast<double>(k) / (2 * static_cast<double>(power.size() - 1));
      all += power[k];
      if (frequency_Hz >= from_Hz && frequency_Hz <= to_Hz) between += power[k];
    }
  }
  return all > 0 ? between / all : 0;
}

}  // namespace palpate
