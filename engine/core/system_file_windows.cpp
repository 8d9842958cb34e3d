#include <windows.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <io.h>
#include <share.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "engine/core/system_file.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxAtOnce = std::size_t{1} << 30;  // maximum count of the runtime's int

// Locks a byte that no file reaches: other programs may read the file meanwhile.
bool hold(int descriptor) noexcept {
  const auto handle = reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor));
  if (::GetFileType(handle) != FILE_TYPE_DISK) return true;
  OVERLAPPED place{};
  place.OffsetHigh = 0x40000000;
  return ::LockFileEx(handle, LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &place) != 0 ||
         ::GetLastError() != ERROR_LOCK_VIOLATION;
}

}  // namespace

std::FILE* openFile(const std::filesystem::path& file, const char* mode) noexcept {
  wchar_t wide[8]{};
  std::copy_n(mode, std::min(std::strlen(mode), std::size(wide) - 1), wide);
  return ::_wfopen(file.c_str(), wide);
}

std::FILE* openScratch(const std::filesystem::path& folder) noexcept {
  try {
    wchar_t name[MAX_PATH]{};
    if (::GetTempFileNameW(folder.c_str(), L"pal", 0, name) == 0) {
      errno = EACCES;
      return nullptr;
    }
    return ::_wfopen(name, L"w+bTD");  // removed when it is closed
  } catch (const std::bad_alloc&) {
    errno = ENOMEM;
    return nullptr;
  }
}

std::FILE* openPipe(const std::filesystem::path& file, double) { return openFile(file, "rb"); }

std::optional<std::size_t> readPipe(std::FILE* pipe, std::span<std::byte> bytes) {
  const std::size_t got = std::fread(bytes.data(), 1, bytes.size(), pipe);
  return got == 0 && std::ferror(pipe) ? std::nullopt : std::optional(got);
}

bool isTerminal(std::FILE* file) noexcept { return ::_isatty(::_fileno(file)) != 0; }

std::size_t readAt(std::FILE* file, std::uint64_t offset, std::span<std::byte> bytes) noexcept {
  const auto handle = reinterpret_cast<HANDLE>(::_get_osfhandle(::_fileno(file)));
  std::size_t got = 0;
  while (got < bytes.size()) {
    OVERLAPPED place{};
    place.Offset = static_cast<DWORD>(offset + got);
    place.OffsetHigh = static_cast<DWORD>((offset + got) >> 32);
    DWORD count = 0;
    const auto most = static_cast<DWORD>(std::min(bytes.size() - got, kMaxAtOnce));
    if (!::ReadFile(handle, bytes.data() + got, most, &count, &place) || count == 0) break;
    got += count;
  }
  return got;
}

bool seekTo(std::FILE* file, std::uint64_t offset) noexcept {
  return ::_fseeki64(file, static_cast<std::int64_t>(offset), SEEK_SET) == 0;
}

bool bringToDisk(std::FILE* file) noexcept { return ::_commit(::_fileno(file)) == 0; }

void removeNow(const wchar_t* file) noexcept { ::DeleteFileW(file); }

std::error_code replaceFile(const std::filesystem::path& from, const std::filesystem::path& to) noexcept {
  if (::MoveFileExW(from.c_str(), to.c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH)) return {};
  switch (::GetLastError()) {
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:  // another program has it open
      return std::make_error_code(std::errc::permission_denied);
    case ERROR_DISK_FULL:
      return std::make_error_code(std::errc::no_space_on_device);
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
      return std::make_error_code(std::errc::no_such_file_or_directory);
    default:
      return std::make_error_code(std::errc::io_error);
  }
}

bool holdAlone(std::FILE* file) noexcept { return hold(::_fileno(file)); }

std::string whyNotWritten(int error) {
  if (error == EAGAIN) return "is being written by another program; end that one, or name another file";
  const bool full = error == ENOSPC || error == EFBIG;
  return fmt::format("cannot be written: {}{}", std::strerror(error), full ? "; free some space" : "");
}

int processNumber() noexcept { return static_cast<int>(::GetCurrentProcessId()); }

int UnbufferedFile::open(const std::filesystem::path& file) noexcept {
  constexpr int kHow = _O_WRONLY | _O_CREAT | _O_BINARY | _O_NOINHERIT;
  descriptor_ = ::_wopen(file.c_str(), kHow, _S_IREAD | _S_IWRITE);
  if (descriptor_ < 0) return errno;
  const bool alone = hold(descriptor_);
  const bool isDisk = ::GetFileType(reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor_))) == FILE_TYPE_DISK;
  const int error = !alone ? EAGAIN : isDisk ? ::_chsize_s(descriptor_, 0) : 0;
  if (error != 0) close();
  return error;
}

int UnbufferedFile::write(std::span<const std::byte> bytes) noexcept {
  while (!bytes.empty()) {
    const auto most = static_cast<unsigned>(std::min(bytes.size(), kMaxAtOnce));
    const int count = ::_write(descriptor_, bytes.data(), most);
    if (count < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return 0;
}

int UnbufferedFile::cutTo(std::uint64_t bytes) noexcept {
  const auto end = static_cast<std::int64_t>(bytes);
  if (const int error = ::_chsize_s(descriptor_, end); error != 0) return error;
  return ::_lseeki64(descriptor_, end, SEEK_SET) != end ? errno : 0;
}

int UnbufferedFile::sync() noexcept {
  const auto handle = reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor_));
  return ::GetFileType(handle) == FILE_TYPE_DISK && ::_commit(descriptor_) != 0 ? errno : 0;
}

int UnbufferedFile::close() noexcept { return isOpen() && ::_close(std::exchange(descriptor_, -1)) != 0 ? errno : 0; }

bool FileLock::take(const std::filesystem::path& file) noexcept {
  release();
  constexpr int kHow = _O_RDWR | _O_CREAT | _O_BINARY | _O_NOINHERIT;
  return ::_wsopen_s(&descriptor_, file.c_str(), kHow, _SH_DENYRW, _S_IREAD | _S_IWRITE) == 0;
}

void FileLock::release() noexcept {
  if (descriptor_ >= 0) ::_close(std::exchange(descriptor_, -1));
}

}  // namespace palpate
