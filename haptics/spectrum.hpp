// How the power of a signal is spread over frequency.
#pragma once

#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Power over frequency by Welch's method (1967): segments that overlap by half, each under a Hann window, their
/// periodograms averaged. Entry k belongs to the frequency k / (2 (size - 1)) of the sampling rate; only the shares
/// mean something, not the scale. `segment` is cut to the signal's length. Empty for fewer than two samples.
std::vector<double> welchPower(std::span<const double> signal, std::size_t segment = 256);

/// The share of the signal's power, constant part included, that lies between two frequencies, its three components
/// added; 0 for a signal without power.
double powerShare(std::span<const DVec3> signal, double rate_Hz, double from_Hz, double to_Hz);

}  // namespace palpate
