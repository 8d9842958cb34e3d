#include <windows.h>

#include <fmt/format.h>
#include <io.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "engine/core/error.hpp"
#include "engine/io/interruptible_input.hpp"

namespace palpate {

namespace {

constexpr DWORD kLook_ms = 2;  // polling interval: a blocking read of a pipe cannot be interrupted
constexpr std::size_t kMaxAtOnce = std::size_t{1} << 30;

}  // namespace

InterruptibleInput::InterruptibleInput(int descriptor) : descriptor_(descriptor) {}
InterruptibleInput::~InterruptibleInput() = default;

std::size_t InterruptibleInput::read(std::span<std::byte> bytes) {
  const auto handle = reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor_));
  const bool isPipe = ::GetFileType(handle) == FILE_TYPE_PIPE;
  while (isPipe && !stopped_) {
    DWORD there = 0;
    if (!::PeekNamedPipe(handle, nullptr, 0, nullptr, &there, nullptr)) return 0;  // the writer has closed it
    if (there > 0) break;
    ::Sleep(kLook_ms);
  }
  if (stopped_) return 0;
  const int count = ::_read(descriptor_, bytes.data(), static_cast<unsigned>(std::min(bytes.size(), kMaxAtOnce)));
  if (count < 0) throw Error("cannot be read: {}", std::strerror(errno));
  return static_cast<std::size_t>(count);
}

void InterruptibleInput::stop() noexcept { stopped_ = true; }

}  // namespace palpate
