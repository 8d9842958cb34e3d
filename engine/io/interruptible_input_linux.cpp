#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "engine/core/error.hpp"
#include "engine/io/interruptible_input.hpp"

namespace palpate {

InterruptibleInput::InterruptibleInput(int descriptor)
    : descriptor_(descriptor), wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (wake_ < 0) throw Error("no more files can be opened: {}", std::strerror(errno));
}

InterruptibleInput::~InterruptibleInput() { ::close(static_cast<int>(wake_)); }

std::size_t InterruptibleInput::read(std::span<std::byte> bytes) {
  while (!stopped_) {
    std::array<pollfd, 2> waits{{{.fd = descriptor_, .events = POLLIN, .revents = 0},
                                 {.fd = static_cast<int>(wake_), .events = POLLIN, .revents = 0}}};
    if (::poll(waits.data(), waits.size(), -1) < 0) {
      if (errno == EINTR) continue;
      throw Error("cannot be waited for: {}", std::strerror(errno));
    }
    if (stopped_) break;
    if (waits[0].revents == 0) continue;
    const ssize_t count = ::read(descriptor_, bytes.data(), bytes.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR && errno != EAGAIN) throw Error("cannot be read: {}", std::strerror(errno));
  }
  return 0;
}

void InterruptibleInput::stop() noexcept {
  stopped_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(static_cast<int>(wake_), &one, sizeof one);
}

}  // namespace palpate
