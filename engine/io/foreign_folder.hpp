// Folders that no format reads: which ones are read, what this one lacks, and what in it can be read.
#pragma once

#include <filesystem>

#include "engine/io/cloud_formats.hpp"

namespace palpate {

/// Throws FileError that says so.
[[noreturn]] void refuseFolder(const std::filesystem::path& folder, const CloudFormats& formats);

}  // namespace palpate
