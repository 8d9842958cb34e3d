#include "engine/core/error.hpp"
#include "engine/io/unpacked_view.hpp"

namespace palpate {

std::vector<std::byte> unpackView(const PackedView&) {
  throw Error(
      "this compression needs the library meshoptimizer, which was not found when palpate was built; export it without "
      "compression, or as PLY or OBJ");
}

}  // namespace palpate
