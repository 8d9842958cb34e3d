// The DDS domain reserved for a test program.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <thread>

#ifndef _WIN32
#include <sys/file.h>
#endif

namespace palpate {

/// A domain that no other test program on this machine uses during this one's lifetime: a file with its number is
/// locked until then. Every call returns the same. Its ports are below the ephemeral ports. own_domain.py and
/// own_domain.sh use the same domains.
inline std::uint32_t ownDomain() {
  static const std::uint32_t own = [] {
    constexpr std::uint32_t kFirst = 20, kCount = 80;
    const std::uint32_t begin = static_cast<std::uint32_t>(::getpid()) % kCount;
#ifdef _WIN32
    return kFirst + begin;
#else
    constexpr int kTurns = 600;  // one minute
    for (int turn = 0; turn < kTurns; ++turn) {
      for (std::uint32_t i = 0; i < kCount; ++i) {
        const std::uint32_t domain = kFirst + (begin + i) % kCount;
        const std::string file = "/tmp/palpate-tests-domain-" + std::to_string(domain);
        // A file of another user can be locked, but not written.
        int lock = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
        if (lock < 0) lock = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (lock < 0) continue;
        if (::flock(lock, LOCK_EX | LOCK_NB) == 0) return domain;  // the lock is held until the program ends
        ::close(lock);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    throw std::runtime_error("all domains of /tmp/palpate-tests-domain-* are in use by other tests");
#endif
  }();
  return own;
}

}  // namespace palpate
