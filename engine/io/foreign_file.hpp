// Recognises files that are not clouds, or clouds of unsupported formats, and says what to do.
#pragma once

#include <filesystem>
#include <string_view>

#include "engine/io/cloud_formats.hpp"

namespace palpate {

/// Folders that no format reads: which ones are read, what this one lacks, and what in it can be read.
/// Throws FileError that says so.
[[noreturn]] void refuseFolder(const std::filesystem::path& folder, const CloudFormats& formats);

/// Throws FileError with the kind of file if it is known and cannot be read: "is an image (PNG), not a 3D file". Pipes
/// are not read.
void refuseForeign(const std::filesystem::path& file);

/// Throws FileError for a file of no known format. `formats`: names of the readable formats.
[[noreturn]] void refuseUnknown(const std::filesystem::path& file, std::string_view formats);

}  // namespace palpate
