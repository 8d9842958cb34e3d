// Selection of the GPU, and of its queues for each policy. Pure decisions from the driver's reports, so that they can
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

/// The properties used for the selection.
struct GpuDescription {
  std::string name;
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
};

/// Index of the GPU to use: `selector` is a number, or a part of a name (any case); empty takes the first discrete,
/// then integrated, then virtual, then CPU device. Throws GpuError that lists the GPUs if none matches.
std::size_t chooseGpu(std::span<const GpuDescription> gpus, const std::string& selector);

/// How the policies share a GPU. All but the first are for comparison.
enum class QueueArrangement {
  separate,    ///< a queue for each policy if there are enough; latency has the highest priority, background the lowest
  noPriority,  ///< the same queues with equal priorities
  same         ///< all share the throughput queue
};
/// The names on the command line.
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
/// The queue of each policy. Latency gets a compute-only family if there is one, otherwise a second queue of the
/// throughput family, otherwise the same queue. Background gets its own queue if there is one more: preferably of that
/// compute-only family, since even short work on a second queue of the graphics family delays latency work by 400 us
/// while something is drawn (seen on an H200). Otherwise it shares the throughput queue.
struct QueueRoles {
  QueueChoice latency, throughput, background;
  bool draws = false;  ///< the throughput queue supports graphics
  /// Latency and throughput share one queue.
  bool shared() const { return latency == throughput; }
  bool backgroundShares() const { return background == throughput; }
  /// The families in use, without duplicates.
  std::vector<std::uint32_t> families() const;
};
/// Empty if no family supports compute. Throughput prefers graphics and falls back to any compute family.
std::optional<QueueRoles> chooseQueues(std::span<const VkQueueFamilyProperties> families,
                                       QueueArrangement arrangement = QueueArrangement::separate);

/// The queues of one family with which a device is created.
struct FamilyQueues {
  std::uint32_t family = 0;
  std::vector<float> priorities;  ///< of each queue, 0 to 1, relative to the other queues of this program
  bool high = false;              ///< high priority relative to other programs, too, if the driver grants it
};
/// The queues that the roles need, by family.
std::vector<FamilyQueues> queuesFor(const QueueRoles& roles, QueueArrangement arrangement);

/// Subgroup sizes that a GPU has, in compute shaders.
struct SubgroupSizes {
  std::uint32_t usual = 0;              ///< if none is required
  std::uint32_t min = 0, max = 0;       ///< powers of two
  std::uint32_t mostInWorkgroup = ~0u;  ///< subgroups, if a pipeline requires their size
  bool canRequire = false;              ///< pipelines can require one of them
};
SubgroupSizes subgroupSizesOf(VkPhysicalDevice device);
inline constexpr std::uint32_t kNarrowestSubgroup = 4, kWidestSubgroup = 64;
/// The sizes that all pipelines can have, at most kWidestSubgroup, the best one first: the usual one, or of Intel's
/// GPUs 16, since their compiler has the most registers for it, and full subgroups without a required size would
/// get 32. The others are for drivers that are wrong with it. Empty if there is no such size.
std::vector<std::uint32_t> usableSubgroupSizes(const SubgroupSizes& sizes, std::uint32_t vendor);

/// The limits that every pipeline fits or adapts to: Vulkan itself guarantees only 128 invocations.
inline constexpr std::uint32_t kFewestInvocations = 256, kMinSharedBytes = 16 * 1024;

/// A required feature or limit, and whether the device has it.
struct FeatureState {
  std::string name;
  bool present;
};
/// Every required feature of a physical device, by its Vulkan name, and every limit with its actual and its required
/// value.
std::vector<FeatureState> requiredFeatures(VkPhysicalDevice device);
/// Throws GpuError that names the device and each missing feature.
void requireFeatures(std::span<const FeatureState> features, const std::string& deviceName);

}  // namespace palpate
