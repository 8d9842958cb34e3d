// Real scans and files, which may be missing.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>

#include "tests/source_folder.hpp"

namespace palpate {

/// A file or folder of modelsFolder(); empty if it is missing, which is reported as a skip.
inline std::filesystem::path sharedFile(const std::filesystem::path& name) {
  const std::filesystem::path file = modelsFolder() / name;
  if (std::filesystem::exists(file)) return file;
  MESSAGE("skipped: no ", file.string());
  return {};
}

}  // namespace palpate
