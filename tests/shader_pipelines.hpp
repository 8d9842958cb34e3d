// Compiles every compute shader of a list on the present driver: validation examines each module, and the driver
// translates it.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <span>
#include <string>

#include "engine/gpu/compute_pipeline.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

/// The words of each instruction of a module (SPIR-V specification, section 2.3).
template <class See>
void forEachInstruction(const ShaderCode& code, See&& see) {
  constexpr std::size_t kHeaderWords = 5;
  for (std::size_t at = kHeaderWords; at < code.words.size();) {
    const std::size_t words = code.words[at] >> 16;
    see(code.words[at] & 0xffff, code.words.subspan(at + 1, words - 1));
    at += words;
  }
}

inline bool isCompute(const ShaderCode& code) {
  constexpr std::uint32_t kOpEntryPoint = 15, kGlCompute = 5;
  bool compute = false;
  forEachInstruction(code, [&](std::uint32_t op, auto operands) {
    if (op == kOpEntryPoint) compute = operands[0] == kGlCompute;
  });
  return compute;
}

inline bool needsInt64(const ShaderCode& code) {
  constexpr std::uint32_t kOpCapability = 17, kInt64 = 11;
  bool needs = false;
  forEachInstruction(code, [&](std::uint32_t op, auto operands) {
    if (op == kOpCapability && operands[0] == kInt64) needs = true;
  });
  return needs;
}

/// The number of shaders that were compiled.
inline std::size_t checkPipelines(Device& device, std::span<const ShaderCode* const> codes) {
  std::size_t count = 0;
  for (const ShaderCode* code : codes) {
    MESSAGE(std::string(code->name));  // after a crash of the driver, the only trace of the shader
    if (needsInt64(*code) && !device.hasWideAtomics()) {
      MESSAGE("skipped: this device has no 64-bit integers, so palpate does not use the shader");
      continue;
    }
    const ShaderStage module(device, *code, {});  // the tests of pictures create pipelines of the other stages
    if (!isCompute(*code)) continue;
    // The maximum of arguments and images over all shaders.
    const ComputePipeline pipeline(device, *code, {.workgroupSize = 128, .pushBytes = kMaxPushBytes, .images = 4});
    CHECK(pipeline.handle() != VK_NULL_HANDLE);
    ++count;
  }
  return count;
}

}  // namespace palpate
