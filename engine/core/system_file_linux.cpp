#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "engine/core/job_stop.hpp"
#include "engine/core/system_file.hpp"

namespace palpate {

std::FILE* openFile(const std::filesystem::path& file, const char* mode) noexcept {
  return std::fopen(file.c_str(), mode);
}

std::FILE* openScratch(const std::filesystem::path& folder) noexcept {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0) return ::fdopen(descriptor, "w+b");
  // The file system has no unnamed files.
  try {
    std::string name = (folder / "scratch-XXXXXX").string();
    const int named = ::mkostemp(name.data(), O_CLOEXEC);
    if (named < 0) return nullptr;
    ::unlink(name.c_str());
    return ::fdopen(named, "w+b");
  } catch (const std::bad_alloc&) {
    errno = ENOMEM;
    return nullptr;
  }
}

namespace {

constexpr int kStep_ms = 20;  // while a pipe is waited for

bool isCut() noexcept { return jobStop.mayCut && isStopWanted(); }

bool hold(int descriptor) noexcept { return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; }

/// Whether a program has opened a pipe for writing, or has left bytes in it: tee(2) finds bytes without consuming them.
bool hasWriter(int pipe) noexcept {
  int copies[2];
  if (::pipe2(copies, O_CLOEXEC | O_NONBLOCK) != 0) return true;  // then the read finds out
  const bool any = ::tee(pipe, copies[1], 1, SPLICE_F_NONBLOCK) != 0;
  ::close(copies[0]);
  ::close(copies[1]);
  return any;
}

}  // namespace

std::FILE* openPipe(const std::filesystem::path& file, double wait_s) {
  const int pipe = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (pipe < 0) return nullptr;
  bool written = hasWriter(pipe);
  for (int left = static_cast<int>(1e3 * wait_s) / kStep_ms; left > 0 && !written && !isCut(); --left) {
    ::poll(nullptr, 0, kStep_ms);
    written = hasWriter(pipe);
  }
  if (!written) {
    ::close(pipe);
    throwIfStopWanted();
    errno = ETIMEDOUT;
    return nullptr;
  }
  ::fcntl(pipe, F_SETFL, ::fcntl(pipe, F_GETFL) & ~O_NONBLOCK);
  return ::fdopen(pipe, "rb");
}

std::optional<std::size_t> readPipe(std::FILE* pipe, std::span<std::byte> bytes) {
  pollfd wait{.fd = ::fileno(pipe), .events = POLLIN, .revents = 0};
  while (::poll(&wait, 1, kStep_ms) <= 0) throwIfStopWanted();
  ssize_t count;
  do count = ::read(wait.fd, bytes.data(), bytes.size());
  while (count < 0 && errno == EINTR);
  return count < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(count));
}

bool isTerminal(std::FILE* file) noexcept { return ::isatty(::fileno(file)) == 1; }

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

void removeNow(const char* file) noexcept { ::unlink(file); }

std::error_code replaceFile(const std::filesystem::path& from, const std::filesystem::path& to) noexcept {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  return error;
}

bool holdAlone(std::FILE* file) noexcept { return hold(::fileno(file)); }

std::string whyNotWritten(int error) {
  if (error == EAGAIN) return "is being written by another program; end that one, or name another file";
  const bool full = error == ENOSPC || error == EDQUOT;
  return fmt::format("cannot be written: {}{}", std::strerror(error),
                     full             ? "; free some space"
                     : error == EFBIG ? "; raise the limit of file sizes (ulimit -f)"
                                      : "");
}

int processNumber() noexcept { return ::getpid(); }

int UnbufferedFile::open(const std::filesystem::path& file) noexcept {
  descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) return errno;
  const bool alone = hold(descriptor_);
  if (alone && (::ftruncate(descriptor_, 0) == 0 || errno == EINVAL)) return 0;  // EINVAL: a pipe or a device
  const int error = alone ? errno : EAGAIN;
  close();
  return error;
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

int UnbufferedFile::close() noexcept {
  if (!isOpen()) return 0;
  ::flock(descriptor_, LOCK_UN);  // also for a child of fork(), which has the descriptor too
  return ::close(std::exchange(descriptor_, -1)) != 0 ? errno : 0;
}

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
