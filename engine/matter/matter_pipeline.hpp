#pragma once

#include <string>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "shaders/shared/matter_state.h"

namespace palpate {

/// A pass in workgroups of kMatterBlock, with `Args` as its push constants.
template <class Args>
ComputePipeline matterPipeline(Device& device, const ShaderCode& code) {
  return {device, code, {.workgroupSize = shared::kMatterBlock, .pushBytes = sizeof(Args)}};
}

/// Buffer of a soft body; only the GPU accesses it.
template <class T>
Buffer softBuffer(Device& device, std::uint64_t count, const char* name) {
  return Buffer::of<T>(device, count, Memory::device, std::string("soft ") + name);
}

}  // namespace palpate
