#include <cstdlib>

#include "haptics/session/cache_folder.hpp"

namespace palpate {

std::filesystem::path cacheFolder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return cache;
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache";
  return {};
}

}  // namespace palpate
