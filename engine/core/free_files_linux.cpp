#include "engine/core/free_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <vector>

namespace palpate {

bool canOpenFiles(std::size_t count) noexcept {
  std::vector<int> opened;
  try {
    opened.reserve(count);
  } catch (...) {
    return false;
  }
  while (opened.size() < count) {
    const int descriptor = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) break;
    opened.push_back(descriptor);
  }
  for (const int descriptor : opened) ::close(descriptor);
  return opened.size() == count;
}

}  // namespace palpate
