// Which GPU, and which of its queues serves which policy. Pure decisions over what the driver reports, so that they can
// be tested without the hardware.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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

/// How the policies share a GPU. All but the first are there to be measured against it.
enum class QueueArrangement {
  separate,    ///< a queue for each policy where there are as many; latency goes first, the background last
  noPriority,  ///< the same queues, and none goes before another
  same         ///< all have the queue of throughput between them
};
/// The names that the user gives.
inline constexpr std::array<std::pair<std::string_view, QueueArrangement>, 3> kQueueArrangements{
    {{"separate", QueueArrangement::separate},
     {"no-priority", QueueArrangement::noPriority},
     {"same", QueueArrangement::same}}};

/// A queue: family and index within it.
struct QueueChoice {
  std::uint32_t family = 0;
  std::uint32_t index = 0;
  bool operator==(const QueueChoice&) const = default;
};
/// The queue of each policy. Latency gets a compute-only family where there is one, else a second queue of the family
/// of throughput, else the same queue. Background work gets a queue of its own where there is one more: of that
/// compute-only family first, since work on a second queue of the graphics family, however short, holds latency up for
/// 400 us while something is drawn (an H200 does so). Else it shares that of throughput.
struct QueueRoles {
  QueueChoice latency, throughput, background;
  bool draws = false;  ///< the queue of throughput has the graphics pipeline
  /// Latency and throughput have one queue between them.
  bool shared() const { return latency == throughput; }
  bool backgroundShares() const { return background == throughput; }
  /// The families in use, each once.
  std::vector<std::uint32_t> families() const;
};
/// Nothing when no family can compute. Throughput wants graphics and falls back to any compute family.
std::optional<QueueRoles> chooseQueues(std::span<const VkQueueFamilyProperties> families,
                                       QueueArrangement arrangement = QueueArrangement::separate);

/// The queues of one family that a device is made with.
struct FamilyQueues {
  std::uint32_t family = 0;
  std::vector<float> priorities;  ///< of each queue, 0 to 1, against the others of this program
  bool high = false;              ///< of high priority against other programs, too, where the driver grants that
};
/// What the roles need, by family.
std::vector<FamilyQueues> queuesFor(const QueueRoles& roles, QueueArrangement arrangement);

/// The least that every pipeline fits into, or is made to fit: Vulkan itself promises 128 invocations.
inline constexpr std::uint32_t kFewestInvocations = 256, kMinSharedBytes = 16 * 1024;

/// A feature or a limit that palpate cannot do without, and whether the device has it.
struct FeatureState {
  std::string name;
  bool present;
};
/// Every required feature of a physical device, by its Vulkan name, and every limit with what it is and what it has to
/// be.
std::vector<FeatureState> requiredFeatures(VkPhysicalDevice device);
/// Throws GpuError that names the device and each missing feature.
void requireFeatures(std::span<const FeatureState> features, const std::string& deviceName);

}  // namespace palpate
