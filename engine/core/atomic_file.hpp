// Output files appear under their name only when they are complete.
#pragma once

#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>

namespace palpate {

/// Whether it exists and is neither a file nor a folder: what is written to it has been read by the time it is closed.
bool isDeviceOrPipe(const std::filesystem::path& path);

/// Writes to a temporary file beside `target`; commit() makes it durable and renames it. If it is destroyed without a
/// commit, the temporary file is removed and an older file of that name stays as it was. Links are followed, and an
/// older file's permissions are kept. Devices and pipes are written to directly. Throws FileError.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  /// Throws unless what was written so far fits on the disk.
  void flush();
  void commit();
  /// Commits, but keeps the older file: as NAME.bak, or as NAME.bak2 and so on where that name is taken. Returns the
  /// name of the kept file; empty if there was no older file. If it cannot be kept, nothing changes.
  std::filesystem::path commitAndKeep();

  /// The name that commitAndKeep() would give the older file now; empty if there is no older file.
  static std::filesystem::path nameToKeep(const std::filesystem::path& target);

 private:
  void close();
  std::filesystem::path keep() const;
  void rename();
  void removeTemporary() const;
  void forgetTemporary() const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;  // empty when the target is written to directly
  std::FILE* file_ = nullptr;
};

/// A name that is removed at the end, with the file of that name, if any.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path path);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Removes TemporaryFiles, and those of all AtomicFiles that are not complete, before the program is ended by a signal;
/// may be called in its handler. (On Windows a file that is still open stays.)
void removeTemporaryFiles() noexcept;

}  // namespace palpate
