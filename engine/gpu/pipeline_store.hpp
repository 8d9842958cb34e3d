#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <vector>

#include "engine/gpu/shader_code.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;
class WorkgroupWatch;

/// Smallest push-constant space that every Vulkan device has, bytes.
inline constexpr std::uint32_t kMaxPushBytes = 128;

/// The compiled pipelines of a device: each is compiled once for each set of options, however many passes use it, since
/// a driver may take seconds for one. They live as long as the device. Any thread may ask.
class PipelineStore {
 public:
  struct Compiled {
    VkDescriptorSetLayout images = VK_NULL_HANDLE;  ///< of those that it reads; none where it reads none
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline pipeline = VK_NULL_HANDLE;
  };
  /// Everything that tells one pipeline from another, the addresses of its shaders' words first.
  using Key = std::vector<std::uint64_t>;

  Compiled get(const Key& key, const std::function<Compiled()>& compile);
  /// From now on shaders are replaced by their twins, where it has some; null ends that.
  void watchBy(const WorkgroupWatch* watch) { watch_ = watch; }
  const WorkgroupWatch* watch() const { return watch_; }
  /// Within `compile` of get(): the module of a shader that lives as long as the device. Those of its table are made
  /// together, in their order.
  VkShaderModule keptModule(Device& device, const ShaderCode& code);
  void destroyAll(Device& device);

 private:
  std::atomic<const WorkgroupWatch*> watch_ = nullptr;
  std::mutex lock_;
  std::map<Key, Compiled> compiled_;
  std::map<const ShaderCode*, VkShaderModule> kept_;
};

/// A shader's module while its pipeline is compiled, and its specialisation constants 0, 1, …. GPU-assisted validation
/// numbers modules as they are made and writes the number into their code: there all are made at once and kept, so that
/// a driver finds in its cache what another process had it translate. `life`: of WorkgroupWatch::Twin; 0: it is not
/// watched.
class ShaderStage {
 public:
  ShaderStage(Device& device, const ShaderCode& code, std::vector<std::uint32_t> constants, DeviceAddress life = 0);
  ~ShaderStage();
  ShaderStage(const ShaderStage&) = delete;
  ShaderStage& operator=(const ShaderStage&) = delete;

  /// Points into this object.
  VkPipelineShaderStageCreateInfo info(VkShaderStageFlagBits stage, VkPipelineShaderStageCreateFlags flags = 0) const;

 private:
  Device& device_;
  std::vector<std::uint32_t> constants_;
  std::vector<VkSpecializationMapEntry> entries_;
  VkSpecializationInfo specialization_{};
  bool isKept_;
  VkShaderModule module_ = VK_NULL_HANDLE;
};

/// `images`: how many a compute shader reads, in set 0; `pushBytes` are for all of `stages`.
void makeLayout(Device& device, VkShaderStageFlags stages, std::uint32_t pushBytes, std::uint32_t images,
                PipelineStore::Compiled& compiled);

}  // namespace palpate
