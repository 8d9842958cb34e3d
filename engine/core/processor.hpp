#pragma once

#include <cstdint>
#include <string>

namespace palpate {

/// The processor's model name; "CPU" where the system does not say.
std::string processorName();

/// How many cores the calling thread may use.
int coresToUse() noexcept;

/// Memory of the machine, or as much of it as a container may have, bytes; 0 where the system does not say.
std::uint64_t hostMemory_bytes();

/// The core that the calling thread runs on now.
int currentCore() noexcept;

}  // namespace palpate
