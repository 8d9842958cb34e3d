// What std::fopen and std::filesystem leave to each system.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>

namespace palpate {

/// As std::fopen, whatever letters the name has.
std::FILE* openFile(const std::filesystem::path& file, const char* mode) noexcept;

/// Opens a named pipe to read, as soon as a program writes to it. Null where none does within `wait_s`, with ETIMEDOUT
/// as errno, or where the system fails.
std::FILE* openPipe(const std::filesystem::path& file, double wait_s) noexcept;

/// Whether it is a keyboard, on which reading waits for somebody.
bool isTerminal(std::FILE* file) noexcept;

/// Reads from `offset` on, on any number of threads at a time, and says how many bytes came: fewer than asked for at
/// the end of the file, or where the system fails. Where the file is read or written otherwise is not to be relied on
/// then.
std::size_t readAt(std::FILE* file, std::uint64_t offset, std::span<std::byte> bytes) noexcept;

/// Where a file without a buffer is read or written next. False: errno says why not.
bool seekTo(std::FILE* file, std::uint64_t offset) noexcept;

/// Brings to the disk what was written to it. False: errno says why not.
bool bringToDisk(std::FILE* file) noexcept;

/// Gives a file another name, in place of one that has it: at any moment there is one of that name.
std::error_code replaceFile(const std::filesystem::path& from, const std::filesystem::path& to) noexcept;

/// "cannot be written: …", and what to do, for a number of errno.
std::string whyNotWritten(int error);

/// The number of this process.
int processNumber() noexcept;

/// A file that is written from its beginning on, without a buffer of our own. Functions that return a number return
/// that of errno, 0 where all went well.
class UnbufferedFile {
 public:
  UnbufferedFile() = default;
  ~UnbufferedFile() { close(); }
  UnbufferedFile(const UnbufferedFile&) = delete;
  UnbufferedFile& operator=(const UnbufferedFile&) = delete;

  /// Makes it, empty. It is not open yet.
  int open(const std::filesystem::path& file) noexcept;
  bool isOpen() const noexcept { return descriptor_ >= 0; }
  int write(std::span<const std::byte> bytes) noexcept;
  /// Takes away what stands behind so many bytes; the next ones are written there.
  int cutTo(std::uint64_t bytes) noexcept;
  /// Brings what is written to the disk; what is no ordinary file, like a pipe, has nothing to bring there.
  int sync() noexcept;
  int close() noexcept;

 private:
  int descriptor_ = -1;
};

/// A file that one program holds at a time, and no more once it has ended, in whatever way.
class FileLock {
 public:
  FileLock() = default;
  ~FileLock() { release(); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// Makes the file where there is none. False: somebody holds it, or the system does not let it be held.
  bool take(const std::filesystem::path& file) noexcept;
  void release() noexcept;

 private:
  int descriptor_ = -1;
};

}  // namespace palpate
