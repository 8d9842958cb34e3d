#include "engine/gpu/device_choice.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <map>

#include "engine/core/unknown_name.hpp"

namespace palpate {

namespace {

std::string lowered(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::vector<std::string> listOf(std::span<const GpuDescription> gpus) {
  std::vector<std::string> list;
  for (std::size_t i = 0; i < gpus.size(); ++i) list.push_back(fmt::format("{} ({})", i, gpus[i].name));
  return list;
}

int rank(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return 3;
    default:
      return 4;
  }
}

}  // namespace

std::size_t chooseGpu(std::span<const GpuDescription> gpus, const std::string& selector) {
  if (gpus.empty())
    throw GpuError("no Vulkan GPU was found; install a driver (the software driver is mesa-vulkan-drivers)");
  if (selector.empty()) {
    const auto best =
        std::ranges::min_element(gpus, [](const auto& a, const auto& b) { return rank(a.type) < rank(b.type); });
    return static_cast<std::size_t>(best - gpus.begin());
  }
  std::size_t number = 0;
  const char* end = selector.data() + selector.size();
  if (const auto [last, error] = std::from_chars(selector.data(), end, number); error == std::errc() && last == end) {
    if (number < gpus.size()) return number;
    throw GpuError("{}", unknownName("GPU number", selector, listOf(gpus)));
  }
  for (std::size_t i = 0; i < gpus.size(); ++i)
    if (lowered(gpus[i].name).find(lowered(selector)) != std::string::npos) return i;
  throw GpuError("{}", unknownName("GPU", selector, listOf(gpus)));
}

std::optional<QueueRoles> chooseQueues(std::span<const VkQueueFamilyProperties> families,
                                       QueueArrangement arrangement) {
  std::optional<std::uint32_t> graphics, computeOnly, anyCompute;
  for (std::uint32_t i = 0; i < families.size(); ++i) {
    const auto flags = families[i].queueFlags;
    if (!(flags & VK_QUEUE_COMPUTE_BIT) || families[i].queueCount == 0) continue;
    if (!anyCompute) anyCompute = i;
    if (flags & VK_QUEUE_GRAPHICS_BIT) {
      if (!graphics) graphics = i;
    } else if (!computeOnly) {
      computeOnly = i;
    }
  }
  if (!anyCompute) return std::nullopt;
  const QueueChoice throughput{graphics.value_or(*anyCompute), 0};
  if (arrangement == QueueArrangement::same)
    return QueueRoles{throughput, throughput, throughput, graphics.has_value()};
  const std::uint32_t ofThroughput = families[throughput.family].queueCount;
  const bool apart = computeOnly && *computeOnly != throughput.family;
  const QueueChoice latency =
      apart ? QueueChoice{*computeOnly, 0} : QueueChoice{throughput.family, ofThroughput > 1 ? 1u : 0u};
  const std::uint32_t next = apart ? 1 : 2;
  QueueChoice background = throughput;
  if (apart && families[latency.family].queueCount > 1)
    background = {latency.family, 1};
  else if (ofThroughput > next)
    background = {throughput.family, next};
  return QueueRoles{latency, throughput, background, graphics.has_value()};
}

std::vector<std::uint32_t> QueueRoles::families() const {
  std::vector<std::uint32_t> all{latency.family};
  for (const QueueChoice& other : {throughput, background})
    if (!std::ranges::count(all, other.family)) all.push_back(other.family);
  return all;
}

std::vector<FamilyQueues> queuesFor(const QueueRoles& roles, QueueArrangement arrangement) {
  constexpr float kLatency = 1.0f, kThroughput = 0.5f, kBackground = 0.0f;
  const bool weighs = arrangement == QueueArrangement::separate;
  std::map<std::uint32_t, std::vector<float>> priorities;
  const auto want = [&](const QueueChoice& choice, float priority) {
    auto& family = priorities[choice.family];
    family.resize(std::max<std::size_t>(family.size(), choice.index + 1));
    family[choice.index] = std::max(family[choice.index], weighs ? priority : kThroughput);
  };
  want(roles.throughput, kThroughput);
  want(roles.latency, kLatency);
  want(roles.background, kBackground);
  std::vector<FamilyQueues> queues;
  queues.reserve(priorities.size());
  for (auto& [family, each] : priorities)
    queues.push_back({family, std::move(each), weighs && family != roles.throughput.family});
  return queues;
}

SubgroupSizes subgroupSizesOf(VkPhysicalDevice device) {
  VkPhysicalDeviceVulkan13Properties v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
  VkPhysicalDeviceSubgroupProperties subgroup{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
                                              .pNext = &v13};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroup};
  vkGetPhysicalDeviceProperties2(device, &properties);
  return {.usual = subgroup.subgroupSize,
          .min = v13.minSubgroupSize,
          .max = v13.maxSubgroupSize,
          .mostInWorkgroup = v13.maxComputeWorkgroupSubgroups,
          .canRequire = (v13.requiredSubgroupSizeStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0};
}

std::vector<std::uint32_t> usableSubgroupSizes(const SubgroupSizes& sizes, std::uint32_t vendor) {
  constexpr std::uint32_t kIntel = 0x8086, kOfIntel = 16;
  std::vector<std::uint32_t> usable;
  const auto add = [&](std::uint32_t size) {
    const bool exists = size == sizes.usual || (sizes.canRequire && size >= sizes.min && size <= sizes.max);
    if (exists && std::has_single_bit(size) && size >= kNarrowestSubgroup && size <= kWidestSubgroup &&
        !std::ranges::count(usable, size))
      usable.push_back(size);
  };
  if (vendor == kIntel) add(kOfIntel);
  add(sizes.usual);
  for (std::uint32_t size = kWidestSubgroup; size >= kNarrowestSubgroup; size /= 2) add(size);
  return usable;
}

std::vector<FeatureState> requiredFeatures(VkPhysicalDevice device) {
  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &v13};
  VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};
  VkPhysicalDeviceSubgroupProperties subgroup{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroup};
  vkGetPhysicalDeviceProperties2(device, &properties);
  const bool has13 = properties.properties.apiVersion >= VK_API_VERSION_1_3;
  if (has13) vkGetPhysicalDeviceFeatures2(device, &features);

  constexpr VkSubgroupFeatureFlags kSubgroup = VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_VOTE_BIT |
                                               VK_SUBGROUP_FEATURE_BALLOT_BIT | VK_SUBGROUP_FEATURE_SHUFFLE_BIT;
  std::vector<FeatureState> states{{"Vulkan 1.3", has13},
                                   {"bufferDeviceAddress", v12.bufferDeviceAddress == VK_TRUE},
                                   {"scalarBlockLayout", v12.scalarBlockLayout == VK_TRUE},
                                   {"synchronization2", v13.synchronization2 == VK_TRUE},
                                   {"computeFullSubgroups", v13.computeFullSubgroups == VK_TRUE},
                                   {"subgroup basic, vote, ballot and shuffle in compute shaders",
                                    (subgroup.supportedOperations & kSubgroup) == kSubgroup &&
                                        (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0}};
  const auto atLeast = [&](const char* limit, std::uint32_t is, std::uint32_t least) {
    states.push_back({fmt::format("{} of {} at least (it is {})", limit, least, is), is >= least});
  };
  const VkPhysicalDeviceLimits& limits = properties.properties.limits;
  atLeast("maxComputeWorkGroupInvocations", limits.maxComputeWorkGroupInvocations, kFewestInvocations);
  atLeast("maxComputeWorkGroupSize[0]", limits.maxComputeWorkGroupSize[0], kFewestInvocations);
  atLeast("maxComputeSharedMemorySize", limits.maxComputeSharedMemorySize, kMinSharedBytes);
  const SubgroupSizes sizes = subgroupSizesOf(device);
  const std::string range = sizes.canRequire ? fmt::format(", {} to {}", sizes.min, sizes.max) : "";
  states.push_back({fmt::format("a subgroup size from {} to {} (it is {}{})", kNarrowestSubgroup, kWidestSubgroup,
                                sizes.usual, range),
                    !usableSubgroupSizes(sizes, properties.properties.vendorID).empty()});
  return states;
}

void requireFeatures(std::span<const FeatureState> features, const std::string& deviceName) {
  std::string missing;
  for (const auto& feature : features)
    if (!feature.present) missing += fmt::format("{}{}", missing.empty() ? "" : ", ", feature.name);
  if (!missing.empty()) throw GpuError("{} lacks {}; update its driver, or choose another GPU", deviceName, missing);
}

}  // namespace palpate
