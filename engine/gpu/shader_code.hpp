#pragma once

#include <cstdint>
#include <span>

namespace palpate {

/// One SPIR-V module, embedded in the program at build time.
struct ShaderCode {
  const char* name;
  std::span<const std::uint32_t> words;
  std::span<const ShaderCode* const> table;  ///< all modules of the same build, in a fixed order
};

}  // namespace palpate
