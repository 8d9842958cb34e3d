// Files that are no clouds, or clouds of formats that are not read: what they are, and what to do.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpate {

/// Throws FileError with what the file is where it is of a kind that is known and not read: "is an image (PNG), not a
/// 3D file". Pipes are not looked into.
void refuseForeign(const std::filesystem::path& file);

/// Throws FileError for a file that no format knows. `formats`: those that are read, in words.
[[noreturn]] void refuseUnknown(const std::filesystem::path& file, std::string_view formats);

}  // namespace palpate
