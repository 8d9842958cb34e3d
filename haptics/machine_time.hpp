// The clock of each system that never goes back, and its finest wait.
#pragma once

#include <cstdint>

namespace palpate {

std::int64_t machineTime_ns() noexcept;
/// The time may have passed already; on return it has.
void waitUntilMachineTime_ns(std::int64_t time_ns) noexcept;

}  // namespace palpate
