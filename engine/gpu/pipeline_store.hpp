#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/gpu/shader_code.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;
class WorkgroupWatch;

/// Minimum push-constant size guaranteed by Vulkan, bytes.
inline constexpr std::uint32_t kMaxPushBytes = 128;

/// The compiled pipelines of a device: each is compiled once for each set of options, for all passes that use it, since
/// a driver may take seconds for one. They live as long as the device. Thread-safe.
class PipelineStore {
 public:
  struct Compiled {
    VkDescriptorSetLayout block = VK_NULL_HANDLE;   ///< of its ConstantBlock; null: it reads none
    VkDescriptorSetLayout images = VK_NULL_HANDLE;  ///< of the images that it reads; null: it reads none
    bool readsBlock = false;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline pipeline = VK_NULL_HANDLE;
  };
  /// Everything that distinguishes pipelines, the addresses of their shaders' words first.
  using Key = std::vector<std::uint64_t>;

  /// Several threads may compile at once.
  Compiled get(const Key& key, const std::function<Compiled()>& compile);
  /// From now on shaders are replaced by their twins, if they have any; null stops that.
  void watchBy(const WorkgroupWatch* watch) { watch_ = watch; }
  const WorkgroupWatch* watch() const { return watch_; }
  /// Within `compile` of get(): the module of a shader, which lives as long as the device. The modules of its table are
  /// made together, in their order.
  VkShaderModule keptModule(Device& device, const ShaderCode& code);
  void destroyAll(Device& device);

 private:
  std::atomic<const WorkgroupWatch*> watch_ = nullptr;
  std::mutex lock_;
  std::condition_variable ended_;                    // a compilation
  std::map<Key, std::optional<Compiled>> compiled_;  // empty while it is compiled
  std::map<const ShaderCode*, VkShaderModule> kept_;
};

/// A shader's module during the compilation of its pipeline, and its specialisation constants 0, 1, …. GPU-assisted
/// validation numbers modules in the order of creation and embeds the number in their code: in that case all modules
/// are created at once and kept, so that a driver's cache has hits across processes. `life`: of WorkgroupWatch::Twin;
/// 0: not watched.
class ShaderStage {
 public:
  ShaderStage(Device& device, const ShaderCode& code, std::vector<std::uint32_t> constants, DeviceAddress life = 0);
  ~ShaderStage();
  ShaderStage(const ShaderStage&) = delete;
  ShaderStage& operator=(const ShaderStage&) = delete;

  /// Points into this object. `subgroupSize`: required; 0: any.
  VkPipelineShaderStageCreateInfo info(VkShaderStageFlagBits stage, VkPipelineShaderStageCreateFlags flags = 0,
                                       std::uint32_t subgroupSize = 0);

 private:
  Device& device_;
  std::vector<std::uint32_t> constants_;
  std::vector<VkSpecializationMapEntry> entries_;
  VkSpecializationInfo specialization_{};
  VkPipelineShaderStageRequiredSubgroupSizeCreateInfo required_{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_REQUIRED_SUBGROUP_SIZE_CREATE_INFO};
  bool isKept_;
  VkShaderModule module_ = VK_NULL_HANDLE;
};

/// Whether a shader reads a ConstantBlock, and does not only declare it: its variable in the storage class Uniform.
bool readsBlock(const ShaderCode& code);

/// `images`: number that a compute shader reads, in set 1; `pushBytes` are for all of `stages`.
/// `compiled.readsBlock` is set before.
void makeLayout(Device& device, VkShaderStageFlags stages, std::uint32_t pushBytes, std::uint32_t images,
                PipelineStore::Compiled& compiled);

}  // namespace palpate
