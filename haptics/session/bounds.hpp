// The bounds of what can be asked of a session: beyond them a number is a slip of the keyboard, or overflows something
// behind it. What has bounds of its own has them beside it.
#pragma once

#include <cstdint>

namespace palpate::bounds {

inline constexpr double kShortest_s = 1e-3, kLongest_s = 1e7;    ///< of what takes time: more than a hundred days
inline constexpr double kShortest_mm = 1e-6, kLongest_mm = 1e9;  ///< a thousand kilometres: terrain at its own scale
inline constexpr double kMinScale = 1e-12, kMaxScale = 1e12;     ///< millimetres per model unit
inline constexpr double kMinStiffness_N_per_mm = 1e-6;           ///< of a hand
inline constexpr double kMaxStiffness_N_per_mm = 1000;           ///< a hundred times what a device holds steady
inline constexpr double kMinDamping_N_s_per_mm = 1e-9, kMaxDamping_N_s_per_mm = 10;
inline constexpr double kMaxForce_N = 1000;
inline constexpr double kMaxSurfacePower_W = 1e6;
inline constexpr double kMaxFriction = 10;
inline constexpr double kMinMemory_MiB = 1e-6, kMaxMemory_MiB = 1e8;
inline constexpr double kMaxCells = 1e6;                           ///< of the index, along the longest side
inline constexpr double kMaxRate_Hz = 1e4;                         ///< of a session
inline constexpr double kMinSpeed = 1e-3, kMaxSpeed = 1e3;         ///< of a recording that is played
inline constexpr double kMinDepthScale = 1, kMaxDepthScale = 1e6;  ///< depth values per metre
inline constexpr std::uint32_t kLastDomain = 230;                  ///< of DDS, of those that have ports
inline constexpr double kMaxCount = 1e9;                           ///< of what is counted
inline constexpr double kMaxSeed = 9e15;                           ///< a double still has every whole number
inline constexpr double kMaxThreads = 1024;

}  // namespace palpate::bounds
