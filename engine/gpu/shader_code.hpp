#pragma once

#include <cstdint>
#include <span>

namespace palpate {

/// One SPIR-V module, embedded in the program when it was built.
struct ShaderCode {
  const char* name;
  std::span<const std::uint32_t> words;
};

}  // namespace palpate
