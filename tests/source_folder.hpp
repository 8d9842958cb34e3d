// Locations of the tests' input files.
#pragma once

#include <filesystem>

namespace palpate {

/// The root of the source tree that the tests were built from.
std::filesystem::path sourceFolder();

/// Real scans and files: in PALPATE_MODELS, or beside the source tree; they may be missing.
std::filesystem::path modelsFolder();

}  // namespace palpate
