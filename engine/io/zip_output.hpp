// Writes ZIP archives (PKWARE's APPNOTE 6.3), deflated, with 64-bit sizes if needed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "engine/core/atomic_file.hpp"

namespace palpate {

/// The archive appears under its name only when it is complete. Throws FileError.
class ZipOutput {
 public:
  explicit ZipOutput(const std::filesystem::path& path) : file_(path) {}

  /// Adds a member; it is stored without compression if it is larger than 1 GiB, or does not become smaller.
  void add(const std::string& name, std::span<const std::byte> bytes);
  /// If `keptAs` is not null, an existing file is kept, and its new path is stored there (AtomicFile::commitAndKeep()).
  void finish(std::filesystem::path* keptAs);

 private:
  void put(const std::string& bytes);

  AtomicFile file_;
  std::uint64_t at_ = 0, members_ = 0;
  std::string list_;  // central directory, written at the end
};

}  // namespace palpate
