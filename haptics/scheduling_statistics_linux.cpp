#include "haptics/scheduling_statistics.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <charconv>
#include <cstring>

namespace palpate {
namespace {

/// "ran_ns waited_ns slices"; 0 if the kernel does not record it.
double waited_us() noexcept {
  char text[96];
  const int file = ::open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const ssize_t length = ::read(file, text, sizeof text);
  ::close(file);
  if (length <= 0) return 0;
  const char* const end = text + length;
  const auto* space = static_cast<const char*>(std::memchr(text, ' ', static_cast<std::size_t>(length)));
  std::uint64_t waited_ns = 0;
  if (space) std::from_chars(space + 1, end, waited_ns);
  return static_cast<double>(waited_ns) * 1e-3;
}

}  // namespace

SchedulingStatistics schedulingOfThisThread() noexcept {
  rusage used{};
  if (::getrusage(RUSAGE_THREAD, &used) != 0) return {};
  return {.preemptions = static_cast<std::uint64_t>(used.ru_nivcsw),
          .pageFaults = static_cast<std::uint64_t>(used.ru_minflt + used.ru_majflt),
          .waited_us = waited_us()};
}

}  // namespace palpate
