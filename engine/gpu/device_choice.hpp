// Which GPU, and which of its queues serves whom. Pure decisions over what the driver reports, so that they can be
// tested without the hardware.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/vulkan.hpp"

namespace palpate {

/// What the choice looks at.
struct GpuDescription {
  std::string name;
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
};

/// Index of the GPU to use: `selector` is a number, or a part of a name (any case); empty takes the first discrete,
/// then integrated, then virtual, then CPU device. Throws GpuError that lists the GPUs when nothing fits.
std::size_t chooseGpu(std::span<const GpuDescription> gpus, const std::string& selector);

/// A queue: family and index within it.
struct QueueChoice {
  std::uint32_t family = 0;
  std::uint32_t index = 0;
  bool operator==(const QueueChoice&) const = default;
};
/// Touch gets a compute-only family where there is one, else a second queue of the sight family, else the same queue.
/// Background work gets a queue of its own where there is one more: of the sight family first, so that touch stays
/// alone in a family of high priority. Else it shares that of sight.
struct QueueRoles {
  QueueChoice touch, sight, background;
  bool draws = false;  ///< sight's queue has the graphics pipeline
  /// Touch and sight have one queue between them.
  bool shared() const { return touch == sight; }
  bool backgroundShares() const { return background == sight; }
  /// The families in use, each once.
  std::vector<std::uint32_t> families() const;
};
/// Nothing when no family can compute. Sight wants graphics and falls back to any compute family.
std::optional<QueueRoles> chooseQueues(std::span<const VkQueueFamilyProperties> families);

/// A feature that palpate cannot do without, and whether the device has it.
struct FeatureState {
  const char* name;
  bool present;
};
/// Every required feature of a physical device, by its Vulkan name.
std::vector<FeatureState> requiredFeatures(VkPhysicalDevice device);
/// Throws GpuError that names the device and each missing feature.
void requireFeatures(std::span<const FeatureState> features, const std::string& deviceName);

}  // namespace palpate
