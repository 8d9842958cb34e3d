// Where a program keeps what it can find out again.
#pragma once

#include <filesystem>

namespace palpate {

/// Folder for a user's caches: $XDG_CACHE_HOME, else ~/.cache; on Windows %LOCALAPPDATA%. Empty if it is unknown.
std::filesystem::path cacheFolder();

}  // namespace palpate
