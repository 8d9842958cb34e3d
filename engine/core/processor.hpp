#pragma once

#include <cstdint>
#include <string>

namespace palpate {

/// The processor's model name; "CPU" where the system does not say.
std::string processorName();

/// How many cores the calling thread may use.
int coresToUse() noexcept;
/// With fewer cores a thread that spins would take the time of those on whose answer it depends.
inline constexpr int kCoresToSpin = 4;

/// Memory of the machine, or as much of it as a container may have, bytes; 0 where the system does not say.
std::uint64_t hostMemory_bytes();

/// The core that the calling thread runs on now.
int currentCore() noexcept;

}  // namespace palpate
