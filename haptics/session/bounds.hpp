// Bounds of a session's parameters: values beyond them are typing errors, or overflow in later code. Bounds of single
// components are defined beside these.
#pragma once

#include <cstdint>

namespace palpate::bounds {

inline constexpr double kShortest_s = 1e-3, kLongest_s = 1e7;  ///< of durations: more than a hundred days
inline constexpr double kShortest_mm = 1e-6,
                        kLongest_mm = 1e9;  ///< of lengths: a thousand kilometres, for terrain at its own scale
inline constexpr double kMinScale = 1e-12, kMaxScale = 1e12;  ///< millimetres per model unit
inline constexpr double kMinStiffness_N_per_mm = 1e-6;        ///< of a hand
inline constexpr double kMaxStiffness_N_per_mm = 1000;        ///< a hundred times what a device renders stably
inline constexpr double kMinDamping_N_s_per_mm = 1e-9, kMaxDamping_N_s_per_mm = 10;
inline constexpr double kMaxForce_N = 1000;
inline constexpr double kMaxSurfacePower_W = 1e6;
inline constexpr double kMaxFriction = 10;
inline constexpr double kMinMemory_MiB = 1e-6, kMaxMemory_MiB = 1e8;
inline constexpr double kMaxRate_Hz = 1e4;                         ///< of a session
inline constexpr double kMinSpeed = 1e-3, kMaxSpeed = 1e3;         ///< of playing a recording
inline constexpr double kMinDepthScale = 1, kMaxDepthScale = 1e6;  ///< depth values per metre
inline constexpr std::uint32_t kLastDomain = 230;                  ///< of the DDS domains that have ports
inline constexpr double kMaxCount = 1e9;                           ///< of counts
inline constexpr double kMaxSeed = 9e15;                           ///< a double represents every integer up to here
inline constexpr double kMaxNeighbours = 1000;                     ///< of a point, in a search for outliers
inline constexpr double kMaxThreads = 1024;

}  // namespace palpate::bounds
