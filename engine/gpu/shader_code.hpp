#pragma once

#include <cstdint>
#include <span>

namespace palpate {

/// One SPIR-V module, embedded in the program when it was built.
struct ShaderCode {
  const char* name;
  std::span<const std::uint32_t> words;
  std::span<const ShaderCode* const> table;  ///< all that were built together with it, in one order
};

}  // namespace palpate
