#include "tests/lost_gpu/made_up_gpu.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace madeup {

namespace {

template <class Struct>
Struct* inChain(const void* chain, VkStructureType type) {
  for (auto* each = static_cast<const VkBaseInStructure*>(chain); each; each = each->pNext)
    if (each->sType == type) return reinterpret_cast<Struct*>(const_cast<VkBaseInStructure*>(each));
  return nullptr;
}

}  // namespace

// Vulkan 1.3, "Required Limits" and "Feature Requirements".
Gpu::Gpu(const std::string& text)
    : values_{{"maxComputeWorkGroupInvocations", 128},
              {"maxComputeWorkGroupSize", 128},
              {"maxComputeWorkGroupCount", 65'535},
              {"maxComputeSharedMemorySize", 16'384},
              {"maxPushConstantsSize", 128},
              {"maxMemoryAllocationCount", 4096},
              {"maxStorageBufferRange", 1 << 27},
              {"maxPerStageDescriptorSampledImages", 16},
              {"maxImageDimension2D", 4096},
              {"maxFramebufferSize", 4096},
              {"maxViewportDimensions", 4096},
              {"maxColorAttachments", 4},
              {"pointSize", 1},
              {"maxMemoryAllocationSize", 1 << 30},
              {"maxBufferSize", 1 << 30},
              {"subgroupSize", 128},
              {"minSubgroupSize", 0},
              {"maxSubgroupSize", 0},
              {"subgroupArithmetic", 0},
              {"vendorID", 0},
              {"deviceType", 0},
              {"queueCount", 1},
              {"timestampValidBits", 0},
              {"shaderInt64", 0},
              {"largePoints", 0},
              {"shaderBufferInt64Atomics", 0},
              {"bufferDeviceAddress", 1},
              {"scalarBlockLayout", 0},
              {"synchronization2", 1},
              {"dynamicRendering", 1},
              {"computeFullSubgroups", 1}} {
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const std::size_t sign = word.find('=');
    const auto known = values_.find(word.substr(0, sign));
    if (sign == std::string::npos || known == values_.end()) {
      std::fprintf(stderr, "made-up GPU: unknown property '%s'\n", word.c_str());
      std::abort();
    }
    known->second = std::strtoull(word.c_str() + sign + 1, nullptr, 10);
  }
}

std::uint64_t Gpu::least(std::uint64_t drivers, const char* name) const { return std::min(drivers, values_.at(name)); }

void Gpu::without(VkBool32& feature, const char* name) const {
  if (!values_.at(name)) feature = VK_FALSE;
}

void Gpu::amend(VkPhysicalDeviceLimits& limits) const {
  const auto cut = [&](std::uint32_t& limit, const char* name) {
    limit = static_cast<std::uint32_t>(least(limit, name));
  };
  cut(limits.maxComputeWorkGroupInvocations, "maxComputeWorkGroupInvocations");
  for (std::uint32_t& size : limits.maxComputeWorkGroupSize) cut(size, "maxComputeWorkGroupSize");
  for (std::uint32_t& count : limits.maxComputeWorkGroupCount) cut(count, "maxComputeWorkGroupCount");
  cut(limits.maxComputeSharedMemorySize, "maxComputeSharedMemorySize");
  cut(limits.maxPushConstantsSize, "maxPushConstantsSize");
  cut(limits.maxMemoryAllocationCount, "maxMemoryAllocationCount");
  cut(limits.maxStorageBufferRange, "maxStorageBufferRange");
  cut(limits.maxPerStageDescriptorSampledImages, "maxPerStageDescriptorSampledImages");
  cut(limits.maxImageDimension2D, "maxImageDimension2D");
  cut(limits.maxFramebufferWidth, "maxFramebufferSize");
  cut(limits.maxFramebufferHeight, "maxFramebufferSize");
  for (std::uint32_t& size : limits.maxViewportDimensions) cut(size, "maxViewportDimensions");
  cut(limits.maxColorAttachments, "maxColorAttachments");
  limits.pointSizeRange[1] = std::min(limits.pointSizeRange[1], static_cast<float>(values_.at("pointSize")));
  limits.timestampComputeAndGraphics = VK_FALSE;
  // Alignments are the maximum that Vulkan allows.
  limits.minStorageBufferOffsetAlignment = limits.minUniformBufferOffsetAlignment = 256;
  limits.nonCoherentAtomSize = 256;
  limits.bufferImageGranularity = 131'072;
}

void Gpu::amend(VkPhysicalDeviceProperties& properties) const {
  amend(properties.limits);
  if (const std::uint64_t type = values_.at("deviceType"))
    properties.deviceType = static_cast<VkPhysicalDeviceType>(type);
  if (const std::uint64_t vendor = values_.at("vendorID")) properties.vendorID = static_cast<std::uint32_t>(vendor);
}

void Gpu::withoutArithmetic(VkSubgroupFeatureFlags& operations) const {
  if (!values_.at("subgroupArithmetic"))
    operations &= ~VkSubgroupFeatureFlags{VK_SUBGROUP_FEATURE_ARITHMETIC_BIT | VK_SUBGROUP_FEATURE_CLUSTERED_BIT};
}

void Gpu::amend(VkPhysicalDeviceProperties2& properties) const {
  amend(properties.properties);
  const void* chain = properties.pNext;
  if (auto* each = inChain<VkPhysicalDeviceMaintenance3Properties>(
          chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES))
    each->maxMemoryAllocationSize = least(each->maxMemoryAllocationSize, "maxMemoryAllocationSize");
  if (auto* each =
          inChain<VkPhysicalDeviceVulkan11Properties>(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES)) {
    each->maxMemoryAllocationSize = least(each->maxMemoryAllocationSize, "maxMemoryAllocationSize");
    each->subgroupSize = static_cast<std::uint32_t>(least(each->subgroupSize, "subgroupSize"));
    withoutArithmetic(each->subgroupSupportedOperations);
  }
  if (auto* each =
          inChain<VkPhysicalDeviceVulkan13Properties>(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES)) {
    each->maxBufferSize = least(each->maxBufferSize, "maxBufferSize");
    if (const std::uint64_t min = values_.at("minSubgroupSize"))
      each->minSubgroupSize = static_cast<std::uint32_t>(min);
    if (const std::uint64_t max = values_.at("maxSubgroupSize"))
      each->maxSubgroupSize = static_cast<std::uint32_t>(max);
  }
  if (auto* each =
          inChain<VkPhysicalDeviceSubgroupProperties>(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES)) {
    each->subgroupSize = static_cast<std::uint32_t>(least(each->subgroupSize, "subgroupSize"));
    withoutArithmetic(each->supportedOperations);
  }
}

void Gpu::amend(VkPhysicalDeviceFeatures& features) const {
  without(features.shaderInt64, "shaderInt64");
  without(features.largePoints, "largePoints");
}

void Gpu::amend(VkPhysicalDeviceFeatures2& features) const {
  amend(features.features);
  if (auto* each = inChain<VkPhysicalDeviceVulkan12Features>(features.pNext,
                                                             VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES)) {
    without(each->shaderBufferInt64Atomics, "shaderBufferInt64Atomics");
    without(each->bufferDeviceAddress, "bufferDeviceAddress");
    without(each->scalarBlockLayout, "scalarBlockLayout");
  }
  if (auto* each = inChain<VkPhysicalDeviceVulkan13Features>(features.pNext,
                                                             VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES)) {
    without(each->synchronization2, "synchronization2");
    without(each->dynamicRendering, "dynamicRendering");
    without(each->computeFullSubgroups, "computeFullSubgroups");
  }
}

void Gpu::amend(VkQueueFamilyProperties& family) const {
  family.queueCount = static_cast<std::uint32_t>(least(family.queueCount, "queueCount"));
  family.timestampValidBits = static_cast<std::uint32_t>(least(family.timestampValidBits, "timestampValidBits"));
}

bool Gpu::accepts(const VkDeviceCreateInfo& info, std::vector<const char*>& extensions) const {
  bool knowsSubset = false;
  for (std::uint32_t i = 0; i < info.enabledExtensionCount; ++i) {
    if (std::strcmp(info.ppEnabledExtensionNames[i], kExtension) != 0) return false;
    knowsSubset = true;
  }
  extensions.clear();
  // A feature that this GPU lacks may not be requested.
  VkPhysicalDeviceFeatures2 asked{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  if (const auto* features =
          inChain<VkPhysicalDeviceFeatures2>(info.pNext, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2))
    asked.features = features->features;
  VkPhysicalDeviceFeatures had = asked.features;
  amend(had);
  const auto* v12 =
      inChain<VkPhysicalDeviceVulkan12Features>(info.pNext, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  const bool wide = v12 && v12->shaderBufferInt64Atomics && !values_.at("shaderBufferInt64Atomics");
  return knowsSubset && !wide && std::memcmp(&had, &asked.features, sizeof had) == 0;
}

}  // namespace madeup
