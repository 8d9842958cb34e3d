#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "engine/core/system_file.hpp"

namespace palpate {

std::FILE* openFile(const std::filesystem::path& file, const char* mode) noexcept {
  return std::fopen(file.c_str(), mode);
}

std::size_t readAt(std::FILE* file, std::uint64_t offset, std::span<std::byte> bytes) noexcept {
  std::size_t got = 0;
  while (got < bytes.size()) {
    const ssize_t count =
        ::pread(::fileno(file), bytes.data() + got, bytes.size() - got, static_cast<off_t>(offset + got));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    got += static_cast<std::size_t>(count);
  }
  return got;
}

bool seekTo(std::FILE* file, std::uint64_t offset) noexcept {
  return ::fseeko(file, static_cast<off_t>(offset), SEEK_SET) == 0;
}

bool bringToDisk(std::FILE* file) noexcept { return ::fsync(::fileno(file)) == 0; }

std::error_code replaceFile(const std::filesystem::path& from, const std::filesystem::path& to) noexcept {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  return error;
}

std::string whyNotWritten(int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return fmt::format("cannot be written: {}{}", std::strerror(error), full ? "; free some space" : "");
}

int processNumber() noexcept { return ::getpid(); }

int UnbufferedFile::open(const std::filesystem::path& file) noexcept {
  descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  return descriptor_ < 0 ? errno : 0;
}

int UnbufferedFile::write(std::span<const std::byte> bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return 0;
}

int UnbufferedFile::cutTo(std::uint64_t bytes) noexcept {
  const auto end = static_cast<off_t>(bytes);
  return ::ftruncate(descriptor_, end) != 0 || ::lseek(descriptor_, end, SEEK_SET) != end ? errno : 0;
}

int UnbufferedFile::sync() noexcept {
  return ::fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS ? errno : 0;
}

int UnbufferedFile::close() noexcept { return isOpen() && ::close(std::exchange(descriptor_, -1)) != 0 ? errno : 0; }

bool FileLock::take(const std::filesystem::path& file) noexcept {
  release();
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) return false;
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return true;
  release();
  return false;
}

void FileLock::release() noexcept {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

}  // namespace palpate
