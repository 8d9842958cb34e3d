// Views of glTF buffers that are compressed by meshoptimizer (EXT_meshopt_compression).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace palpate {

struct PackedView {
  std::span<const std::byte> bytes;
  std::size_t count = 0, stride = 0;  ///< of the unpacked elements
  std::string mode, filter;           ///< in the words of the extension
};

/// Returns `count` elements of `stride` bytes. Throws Error if the bytes are damaged, or the library is not built in.
std::vector<std::byte> unpackView(const PackedView& view);

}  // namespace palpate
