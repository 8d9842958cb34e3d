#pragma once

#include <cstdint>
#include <string>

namespace palpate {

/// The processor's model name; "CPU" if unknown.
std::string processorName();

/// Number of cores that the calling thread may use.
int coresToUse() noexcept;
/// With fewer cores a spinning thread would take the time of the threads that it waits for.
inline constexpr int kCoresToSpin = 4;

/// Memory of the machine, or the container's limit, bytes; 0 if unknown.
std::uint64_t hostMemory_bytes();

/// The core that the calling thread currently runs on.
int currentCore() noexcept;

}  // namespace palpate
