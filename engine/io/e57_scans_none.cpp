#include "engine/core/error.hpp"
#include "engine/io/e57_scans.hpp"

namespace palpate {

bool canReadE57() { return false; }

E57Contents readE57Contents(const E57Pages& pages) {
  throw FileError(pages.file(),
                  "E57 needs the library pugixml, without which this program was built; convert it "
                  "elsewhere, or build it with libpugixml-dev");
}

}  // namespace palpate
