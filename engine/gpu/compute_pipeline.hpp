#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/gpu/shader_code.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;

/// Smallest push-constant space that every Vulkan device has, bytes.
inline constexpr std::uint32_t kMaxPushBytes = 128;

struct PipelineOptions {
  std::uint32_t workgroupSize = 256;          ///< invocations; specialisation constant 0; a multiple of 32
  std::uint32_t pushBytes = 0;                ///< exact size of the arguments
  std::vector<std::uint32_t> constants = {};  ///< specialisation constants 1, 2, …
};

/// A compute shader without descriptor sets: buffers come by address in the push constants.
class ComputePipeline {
 public:
  ComputePipeline(Device& device, const ShaderCode& code, const PipelineOptions& options);
  ~ComputePipeline();
  ComputePipeline(const ComputePipeline&) = delete;
  ComputePipeline& operator=(const ComputePipeline&) = delete;

  VkPipeline handle() const { return pipeline_; }
  VkPipelineLayout layout() const { return layout_; }
  std::uint32_t workgroupSize() const { return workgroupSize_; }
  std::uint32_t pushBytes() const { return pushBytes_; }
  const std::string& name() const { return name_; }

 private:
  Device& device_;
  std::string name_;
  std::uint32_t workgroupSize_, pushBytes_;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace palpate
