// Distribution of a signal's power over frequency.
#pragma once

#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Power over frequency by Welch's method (1967): segments that overlap by half, each under a Hann window, their
/// periodograms averaged. Entry k is at the frequency k / (2 (size - 1)) of the sampling rate; only ratios are
/// meaningful, not the scale. `segment` is limited to the signal's length. Empty for fewer than two samples.
std::vector<double> welchPower(std::span<const double> signal, std::size_t segment = 256);

/// Share of the signal's power, constant part included, between two frequencies, summed over its three components; 0
/// for a signal without power.
double powerShare(std::span<const DVec3> signal, double rate_Hz, double from_Hz, double to_Hz);

}  // namespace palpate
