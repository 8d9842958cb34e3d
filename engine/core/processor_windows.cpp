#include "engine/core/processor.hpp"

#include <windows.h>

#include <array>
#include <bit>

namespace palpate {

std::string processorName() {
  std::array<char, 256> name{};
  DWORD bytes = sizeof name;
  const bool known =
      ::RegGetValueA(HKEY_LOCAL_MACHINE, "HARDWARE\\DESCRIPTION\\System\\CentralProcessor\\0", "ProcessorNameString",
                     RRF_RT_REG_SZ, nullptr, name.data(), &bytes) == ERROR_SUCCESS;
  return known && name[0] ? name.data() : "CPU";
}

int coresToUse() noexcept {
  DWORD_PTR allowed = 0, there = 0;
  return ::GetProcessAffinityMask(::GetCurrentProcess(), &allowed, &there) ? std::popcount(allowed) : 1;
}

std::uint64_t hostMemory_bytes() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  return ::GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : 0;
}

int currentCore() noexcept { return static_cast<int>(::GetCurrentProcessorNumber()); }

}  // namespace palpate
