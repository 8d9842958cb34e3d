#include "haptics/crash_stop.hpp"

#include <array>
#include <atomic>
#include <csignal>
#include <mutex>

#include "engine/core/check.hpp"

namespace palpate {
namespace {

constexpr std::array kSignals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGINT, SIGHUP, SIGQUIT};

// A handler has no arguments of its own choosing, so what it needs has to stand where it can find it.
std::array<std::atomic<HapticDevice*>, CrashStop::kMostDevices> devices;
std::array<struct sigaction, kSignals.size()> former;  // written before a handler is in place
std::mutex places;                                     // for putting handlers in place and back; never held by one
int guarded = 0;

static_assert(std::atomic<HapticDevice*>::is_always_lock_free, "a lock in a signal handler may never be given back");

/// From an instruction that faulted, rather than from someone who sent it.
bool isFault(int signal, const siginfo_t* info) {
  const bool mayBe = signal == SIGSEGV || signal == SIGBUS || signal == SIGFPE || signal == SIGILL;
  return mayBe && info->si_code > 0;
}

void stopThenGoOn(int signal, siginfo_t* info, void* context) {
  for (const auto& slot : devices)
    if (HapticDevice* device = slot.load()) device->emergencyStop();
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    if (kSignals[i] != signal) continue;
    const struct sigaction& before = former[i];
    if (before.sa_flags & SA_SIGINFO) return before.sa_sigaction(signal, info, context);
    if (before.sa_handler != SIG_DFL) return before.sa_handler(signal);
    ::sigaction(signal, &before, nullptr);
    // A fault comes again by itself on return, with its own address for the debugger; anything else is sent again.
    if (!isFault(signal, info)) ::raise(signal);
    return;
  }
}

void putInPlace() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals[i], nullptr, &former[i]);
    if (!(former[i].sa_flags & SA_SIGINFO) && former[i].sa_handler == SIG_IGN) continue;
    struct sigaction ours {};
    ours.sa_sigaction = stopThenGoOn;
    ours.sa_flags = SA_SIGINFO | SA_RESTART | SA_ONSTACK;
    ::sigemptyset(&ours.sa_mask);
    ::sigaction(kSignals[i], &ours, nullptr);
  }
}

void putBack() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &former[i], nullptr);
}

}  // namespace

CrashStop::CrashStop(HapticDevice& device) {
  const std::scoped_lock lock(places);
  while (slot_ < kMostDevices && devices[slot_].load()) ++slot_;
  PALPATE_CHECK_LT(slot_, kMostDevices);
  devices[slot_].store(&device);
  if (guarded++ == 0) putInPlace();
}

CrashStop::~CrashStop() {
  const std::scoped_lock lock(places);
  if (--guarded == 0) putBack();
  devices[slot_].store(nullptr);
}

}  // namespace palpate
