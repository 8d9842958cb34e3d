// File operations that differ between systems beyond std::fopen and std::filesystem.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace palpate {

/// As std::fopen, for file names in any characters.
std::FILE* openFile(const std::filesystem::path& file, const char* mode) noexcept;

/// Opens a new file in `folder` for writing and reading, which has no name there, or loses it when it is closed or the
/// program ends. Null: see errno.
std::FILE* openScratch(const std::filesystem::path& folder) noexcept;

/// Opens a named pipe for reading, as soon as a program writes to it. Null with errno ETIMEDOUT if none does within
/// `wait_s`, or if the system call fails. While it waits, the job of this thread may be cut (throws Stopped).
std::FILE* openPipe(const std::filesystem::path& file, double wait_s);
/// Waits for bytes in such a pipe, as openPipe() does, and reads what is there; 0 at the end. Nothing: see errno.
std::optional<std::size_t> readPipe(std::FILE* pipe, std::span<std::byte> bytes);

/// Whether the file is a keyboard, so that reading waits for input.
bool isTerminal(std::FILE* file) noexcept;

/// Reads from `offset` on, from any number of threads at a time. Returns the number of bytes read: fewer than requested
/// at the end of the file, or if the system call fails. Afterwards the file's own read and write position is undefined.
std::size_t readAt(std::FILE* file, std::uint64_t offset, std::span<std::byte> bytes) noexcept;

/// Sets the next read or write position of an unbuffered file. False: see errno.
bool seekTo(std::FILE* file, std::uint64_t offset) noexcept;

/// Flushes written data to the disk. False: see errno.
bool bringToDisk(std::FILE* file) noexcept;

/// Renames a file, replacing an existing one of that name: a file of that name exists at any moment.
std::error_code replaceFile(const std::filesystem::path& from, const std::filesystem::path& to) noexcept;

/// Removes a file, if there is one; may be called in a signal handler.
void removeNow(const std::filesystem::path::value_type* file) noexcept;

/// Holds the file for this program, so that no second one writes it, until it is closed. True also where the file
/// system has no locks, and for pipes and other special files. False: another holds it.
bool holdAlone(std::FILE* file) noexcept;

/// "cannot be written: …", and what to do, for an errno value.
std::string whyNotWritten(int error);

/// The id of this process.
int processNumber() noexcept;

/// A file that is written from its beginning on, without a buffer of our own. Functions that return int return an errno
/// value, 0 on success.
class UnbufferedFile {
 public:
  UnbufferedFile() = default;
  ~UnbufferedFile() { close(); }
  UnbufferedFile(const UnbufferedFile&) = delete;
  UnbufferedFile& operator=(const UnbufferedFile&) = delete;

  /// Creates it, or empties it. It must not be open. EAGAIN, and no change to the file: another program
  /// writes it.
  int open(const std::filesystem::path& file) noexcept;
  bool isOpen() const noexcept { return descriptor_ >= 0; }
  int write(std::span<const std::byte> bytes) noexcept;
  /// Truncates the file to `bytes`; the next bytes are written there.
  int cutTo(std::uint64_t bytes) noexcept;
  /// Flushes written data to the disk; has no effect on pipes and other special files.
  int sync() noexcept;
  int close() noexcept;

 private:
  int descriptor_ = -1;
};

/// A file that one program holds at a time. The lock ends with the program, however it ends.
class FileLock {
 public:
  FileLock() = default;
  ~FileLock() { release(); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// Creates the file if it does not exist. False: another program holds it, or the system does not support the lock.
  bool take(const std::filesystem::path& file) noexcept;
  void release() noexcept;

 private:
  int descriptor_ = -1;
};

}  // namespace palpate
