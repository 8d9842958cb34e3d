#include "engine/core/thread_priority.hpp"

#include <windows.h>

#include <tlhelp32.h>

#include <algorithm>
#include <exception>

namespace palpate {

namespace {

void makeNice(HANDLE thread) noexcept {
  if (::GetThreadPriority(thread) > THREAD_PRIORITY_LOWEST) ::SetThreadPriority(thread, THREAD_PRIORITY_LOWEST);
}

// Sorted.
std::vector<std::uint32_t> runningThreads() {
  std::vector<std::uint32_t> threads;
  const HANDLE all = ::CreateToolhelp32Snapshot(TH32CS_SNAPTHREAD, 0);
  if (all == INVALID_HANDLE_VALUE) return threads;
  const DWORD process = ::GetCurrentProcessId();
  THREADENTRY32 entry{};
  entry.dwSize = sizeof entry;
  for (BOOL more = ::Thread32First(all, &entry); more; more = ::Thread32Next(all, &entry))
    if (entry.th32OwnerProcessID == process) threads.push_back(entry.th32ThreadID);
  ::CloseHandle(all);
  std::ranges::sort(threads);
  return threads;
}

}  // namespace

void giveWay() noexcept { makeNice(::GetCurrentThread()); }

RunningThreads::RunningThreads() : threads_(runningThreads()) {}

void RunningThreads::laterOnesGiveWay() const noexcept {
  try {
    for (const std::uint32_t number : runningThreads()) {
      if (std::ranges::binary_search(threads_, number)) continue;
      const HANDLE thread = ::OpenThread(THREAD_QUERY_INFORMATION | THREAD_SET_INFORMATION, FALSE, number);
      if (!thread) continue;  // the thread has ended
      makeNice(thread);
      ::CloseHandle(thread);
    }
  } catch (const std::exception&) {  // out of memory: priorities stay
  }
}

AwayFromCore::AwayFromCore(int core) noexcept {
  constexpr int kMaxCores = 64;  // of a processor group, which a thread does not leave
  DWORD_PTR allowed = 0, there = 0;
  if (core < 0 || core >= kMaxCores || !::GetProcessAffinityMask(::GetCurrentProcess(), &allowed, &there)) return;
  const DWORD_PTR others = allowed & ~(DWORD_PTR{1} << core);
  before_[0] = others ? ::SetThreadAffinityMask(::GetCurrentThread(), others) : 0;
  away_ = before_[0] != 0;
}

AwayFromCore::~AwayFromCore() {
  if (away_) ::SetThreadAffinityMask(::GetCurrentThread(), static_cast<DWORD_PTR>(before_[0]));
}

}  // namespace palpate
