// Recognises files that are not clouds, or clouds of unsupported formats, and says what to do.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpate {

/// Throws FileError with the kind of file if it is known and cannot be read: "is an image (PNG), not a 3D file". Pipes
/// are not read.
void refuseForeign(const std::filesystem::path& file);

/// Throws FileError for a file of no known format. `formats`: names of the readable formats.
[[noreturn]] void refuseUnknown(const std::filesystem::path& file, std::string_view formats);

}  // namespace palpate
