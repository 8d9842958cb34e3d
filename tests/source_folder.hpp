// Where what tests read lies that is not compiled in.
#pragma once

#include <filesystem>

namespace palpate {

/// The top of the tree that the tests were built from.
std::filesystem::path sourceFolder();

/// Real scans and files: where PALPATE_MODELS says, or beside the tree; they may not be there.
std::filesystem::path modelsFolder();

}  // namespace palpate
