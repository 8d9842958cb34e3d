// Output files appear under their name only when they are whole.
#pragma once

#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// Whether it is there and neither a file nor a folder: what is written to it has been read by the time it is closed.
bool isDeviceOrPipe(const std::filesystem::path& path);

/// Writes to a temporary file beside `target`; commit() makes it durable and renames it. If it is destroyed without a
/// commit, the temporary file is removed and an older file of that name stays as it was. A link is followed, and an
/// older file's permissions are kept. What is no ordinary file (a device, a pipe) is written to directly. Throws
/// FileError.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  void commit();
  /// The same, but an older file stays: as NAME.bak, or as NAME.bak2 and so on where that is taken. Says as what; empty
  /// where there was none. Where it cannot be kept nothing changes.
  std::filesystem::path commitAndKeep();

  /// What commitAndKeep() would call an older file now; empty where there is none.
  static std::filesystem::path nameToKeep(const std::filesystem::path& target);

 private:
  void close();
  std::filesystem::path keep() const;
  void rename();
  void removeTemporary() const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;  // empty when the target is written to directly
  std::FILE* file_ = nullptr;
};

}  // namespace palpate
