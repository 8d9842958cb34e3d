// Writing ZIP archives (PKWARE's APPNOTE 6.3), deflated, with sizes of 64 bits where they need them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/core/atomic_file.hpp"

namespace palpate {

/// An archive appears under its name only when it is whole. Throws FileError.
class ZipOutput {
 public:
  explicit ZipOutput(const std::filesystem::path& path) : file_(path) {}

  /// A member; what is larger than 1 GiB, or does not become smaller, is stored as it is.
  void add(const std::string& name, std::span<const std::byte> bytes);
  /// Where `keptAs` is not null an older file is kept, and its new name put there (AtomicFile::commitAndKeep()).
  void finish(std::filesystem::path* keptAs);

 private:
  void put(const std::string& bytes);

  AtomicFile file_;
  std::uint64_t at_ = 0, members_ = 0;
  std::string list_;  // what stands at the end
};

}  // namespace palpate
