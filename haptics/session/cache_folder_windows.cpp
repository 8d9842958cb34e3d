#include <windows.h>

#include <cstdlib>

#include "haptics/session/cache_folder.hpp"

namespace palpate {

std::filesystem::path cacheFolder() {
  const wchar_t* cache = ::_wgetenv(L"LOCALAPPDATA");
  return cache ? std::filesystem::path(cache) : std::filesystem::path();
}

}  // namespace palpate
