#include "tests/source_folder.hpp"

#include <cstdlib>

namespace palpate {

std::filesystem::path sourceFolder() { return PALPATE_SOURCE_DIR; }

std::filesystem::path modelsFolder() {
  if (const char* given = std::getenv("PALPATE_MODELS")) return given;
  return sourceFolder() / ".." / "shared" / "models";
}

}  // namespace palpate
