#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/gpu/pipeline_store.hpp"

namespace palpate {

/// Bytes of shared memory, to which passes adapt.
std::uint32_t sharedBytes(const Device& device);

struct PipelineOptions {
  std::uint32_t workgroupSize = 256;          ///< invocations; specialisation constant 0; a multiple of 32
  std::uint32_t pushBytes = 0;                ///< exact size of the arguments
  std::vector<std::uint32_t> constants = {};  ///< specialisation constants 1, 2, …
  /// Invocations per slice, if a list yields (CommandList). An H200 takes about 30 us for this number in the slower
  /// passes, and 3 us between two slices.
  std::uint32_t sliceThreads = 1 << 19;
  std::uint32_t images = 0;  ///< number of images that it reads (ImageReads): bindings 0, 1, … of set 1
};

/// A compute shader: buffers are passed by address in the push constants, and only images and a ConstantBlock need
/// descriptor sets.
class ComputePipeline {
 public:
  ComputePipeline(Device& device, const ShaderCode& code, const PipelineOptions& options);

  VkPipeline handle() const { return compiled_.pipeline; }
  VkPipelineLayout layout() const { return compiled_.layout; }
  VkDescriptorSetLayout imageLayout() const { return compiled_.images; }
  bool readsBlock() const { return compiled_.readsBlock; }
  std::uint32_t workgroupSize() const { return workgroupSize_; }
  std::uint32_t sliceThreads() const { return sliceThreads_; }
  std::uint32_t pushBytes() const { return pushBytes_; }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::uint32_t workgroupSize_, sliceThreads_, pushBytes_;
  PipelineStore::Compiled compiled_;
};

}  // namespace palpate
