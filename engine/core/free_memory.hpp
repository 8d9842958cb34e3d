#pragma once

#include <cstdint>

namespace palpate {

/// Memory that this program can still take without swapping: of the machine, of its container, and up to its own
/// limit (ulimit -v), whichever is least; bytes.
std::uint64_t freeMemory_bytes() noexcept;
/// Addresses that this program can still take up to its own limit (ulimit -v), as the stacks of threads do; bytes.
std::uint64_t freeAddresses_bytes() noexcept;

}  // namespace palpate
