// Random numbers by counter: number `index` of stream `seed` is a pure function of both, so any thread can compute any
// of them and the result never depends on how the work was split. The mixing is the finaliser of SplitMix64 (Steele,
// Lea and Flood 2014, "Fast splittable pseudorandom number generators").
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "engine/core/vec.hpp"

namespace palpate {

inline std::uint64_t randomBits(std::uint64_t seed, std::uint64_t index) {
  const auto mix = [](std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  };
  return mix(mix(seed + 0x9E3779B97F4A7C15u) + 0x9E3779B97F4A7C15u * (index + 1));
}

/// Uniform in [0, 1).
inline double randomUnit(std::uint64_t seed, std::uint64_t index) {
  return static_cast<double>(randomBits(seed, index) >> 11) * 0x1p-53;
}

/// Three independent normal deviates (mean 0, deviation 1), by Box and Muller 1958.
inline DVec3 randomNormal3(std::uint64_t seed, std::uint64_t index) {
  const auto uniform = [&](std::uint64_t k) { return randomUnit(seed, 4 * index + k); };
  const double r0 = std::sqrt(-2 * std::log(1 - uniform(0)));
  const double r1 = std::sqrt(-2 * std::log(1 - uniform(1)));
  const double angle0 = 2 * std::numbers::pi * uniform(2);
  const double angle1 = 2 * std::numbers::pi * uniform(3);
  return {r0 * std::cos(angle0), r0 * std::sin(angle0), r1 * std::cos(angle1)};
}

}  // namespace palpate
