// Each system's monotonic clock, and its finest wait.
#pragma once

#include <cstdint>

namespace palpate {

std::int64_t machineTime_ns() noexcept;
/// Waits until that time; returns at once if it has passed.
void waitUntilMachineTime_ns(std::int64_t time_ns) noexcept;

}  // namespace palpate
