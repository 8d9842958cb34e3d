#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "engine/gpu/shader_code.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;
class WorkgroupWatch;

/// Smallest push-constant space that every Vulkan device has, bytes.
inline constexpr std::uint32_t kMaxPushBytes = 128;

struct PipelineOptions {
  std::uint32_t workgroupSize = 256;          ///< invocations; specialisation constant 0; a multiple of 32
  std::uint32_t pushBytes = 0;                ///< exact size of the arguments
  std::vector<std::uint32_t> constants = {};  ///< specialisation constants 1, 2, …
};

/// The compiled pipelines of a device: each shader is compiled once for each set of options, however many passes use
/// it, since a driver may take seconds for one. They live as long as the device. Any thread may ask.
class PipelineStore {
 public:
  struct Compiled {
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline pipeline = VK_NULL_HANDLE;
  };

  Compiled get(Device& device, const ShaderCode& code, const PipelineOptions& options);
  /// From now on shaders are replaced by their twins, where it has some; null ends that.
  void watch(const WorkgroupWatch* watch);
  void destroyAll(Device& device);

 private:
  using Key = std::tuple<const void*, std::uint32_t, std::uint32_t, std::vector<std::uint32_t>, std::uint64_t>;
  std::mutex lock_;
  const WorkgroupWatch* watch_ = nullptr;
  std::map<Key, Compiled> compiled_;
};

/// A compute shader without descriptor sets: buffers come by address in the push constants.
class ComputePipeline {
 public:
  ComputePipeline(Device& device, const ShaderCode& code, const PipelineOptions& options);

  VkPipeline handle() const { return compiled_.pipeline; }
  VkPipelineLayout layout() const { return compiled_.layout; }
  std::uint32_t workgroupSize() const { return workgroupSize_; }
  std::uint32_t pushBytes() const { return pushBytes_; }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::uint32_t workgroupSize_, pushBytes_;
  PipelineStore::Compiled compiled_;
};

}  // namespace palpate
