#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/compute_pipeline.hpp"
#include "engine/gpu/device_choice.hpp"
#include "engine/gpu/instance.hpp"
#include "engine/gpu/queue.hpp"

namespace palpate {

struct Features;
struct HostDevice;

struct DeviceOptions {
  std::string gpu;  ///< number or part of a name; empty: PALPATE_GPU, otherwise the best available
  Validation validation = Validation::off;
  QueueArrangement queues = QueueArrangement::separate;
  /// Of all pipelines: one of Device::subgroupSizes(), or 0 for the best.
  std::uint32_t subgroupSize = 0;
  bool shows = false;  ///< shows pictures in a window: adds a queue for the thread that shows them
  /// Extensions of the instance for a device that presents them to the window system itself.
  std::vector<std::string> windowExtensions = {};
};

std::vector<VkQueueFamilyProperties> queueFamiliesOf(VkPhysicalDevice device);
bool canMakeSwapchains(VkPhysicalDevice device);

/// A GPU in use: its logical device, its queues by their policies and its limits. Must outlive everything made from it.
class Device {
 public:
  explicit Device(const DeviceOptions& options);
  /// Uses a device that another program has made and also uses. Its objects stay when this is destroyed: only objects
  /// made through this are destroyed. Throws GpuError that names missing features.
  explicit Device(const HostDevice& host);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkDevice handle() const { return device_; }
  VkPhysicalDevice physical() const { return physical_; }
  const VolkDeviceTable& vk() const { return table_; }
  const std::string& name() const { return name_; }
  Instance& instance() { return *instance_; }

  /// For short work with a waiting caller: compute-only and of high priority if the device has such a family.
  Queue& latencyQueue() { return *latency_; }
  /// For long work, which yields to latency work; with graphics if the device supports it.
  Queue& throughputQueue() { return *throughput_; }
  /// A second handle to the throughput queue, for the thread that shows pictures; only if the options request it.
  Queue& window() { return *window_; }
  /// For work without a waiting caller, which must not delay latency work. Used by the thread that uses latencyQueue().
  Queue& backgroundQueue() { return *background_; }
  const QueueRoles& roles() const { return roles_; }
  PipelineStore& pipelines() { return pipelines_; }

  bool isCpu() const { return properties_.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
  const VkPhysicalDeviceProperties& properties() const { return properties_; }
  /// Of all pipelines.
  std::uint32_t subgroupSize() const { return subgroupSize_; }
  /// Those that they can have, the best one first.
  std::vector<std::uint32_t> subgroupSizes() const;
  /// Whether pipelines have to require it: the driver has others.
  bool requiresSubgroupSize() const { return requiresSubgroupSize_; }
  /// Maximum number of invocations of a workgroup.
  std::uint32_t widestWorkgroup() const { return widestWorkgroup_; }
  /// Whether shaders support 64-bit atomic additions in buffers.
  bool hasWideAtomics() const { return hasWideAtomics_; }
  /// Whether shaders can read a device-wide clock.
  bool hasClock() const { return hasClock_; }
  VkDriverId driverId() const { return driverId_; }
  /// Whether the throughput queue can draw into images (CommandList::draw), including points of any size.
  bool draws() const { return draws_; }
  /// Maximum point size of a draw, pixels.
  float largestPoint_px() const { return properties_.limits.pointSizeRange[1]; }
  /// Maximum size of one buffer, bytes.
  std::uint64_t largestBuffer() const { return largestBuffer_; }
  /// Nanoseconds per tick of the GPU's clock.
  double timestampPeriod_ns() const { return properties_.limits.timestampPeriod; }
  /// The valid bits of a queue family's timestamps; 0 if it has none.
  std::uint64_t timestampMask(std::uint32_t queueFamily) const;
  const VkPhysicalDeviceMemoryProperties& memory() const { return memory_; }
  /// Total size of the GPU's own memory heaps, bytes.
  std::uint64_t ownMemory() const;
  /// Bytes of memory that buffers hold at present, of every kind.
  std::uint64_t allocatedBytes() const { return allocated_.load(std::memory_order_relaxed); }
  /// Whether there is latency work with a waiting caller: the throughput queue then yields (CommandList).
  bool hasUrgentWork() const { return urgent_.load(std::memory_order_relaxed) > 0; }
  /// Called at the start (1) and end (-1) of such work.
  void noteUrgentWork(int change) { urgent_.fetch_add(change, std::memory_order_relaxed); }
  /// Called when buffers are created and destroyed.
  void noteAllocation(std::uint64_t bytes) { allocated_.fetch_add(bytes, std::memory_order_relaxed); }
  void noteRelease(std::uint64_t bytes) { allocated_.fetch_sub(bytes, std::memory_order_relaxed); }
  /// Spinning if the driver has its own cores, blocking if it shares ours.
  Wait defaultWait() const;

  void check(VkResult result, std::string_view call) const { checkVk(result, call, name_); }
  /// Waits for all work submitted through this; on an owned device, for all its work.
  void waitIdle() const;
  /// Names a Vulkan object for debuggers and validation messages.
  void nameObject(VkObjectType type, std::uint64_t handle, const std::string& name) const;

 private:
  void readProperties();
  void createLogicalDevice(const DeviceOptions& options);
  void takeUp(const Features& enabled, std::uint32_t subgroupSize = 0);
  using MakeQueue = std::function<std::shared_ptr<SharedQueue>(VkQueue)>;
  struct QueueHandles {
    VkQueue latency, throughput, background;
  };
  void createQueues(const QueueHandles& handles, const MakeQueue& make);
  void destroyQueues();

  std::unique_ptr<Instance> instance_;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  std::string name_;
  VkPhysicalDeviceProperties properties_{};
  VkPhysicalDeviceMemoryProperties memory_{};
  std::uint32_t subgroupSize_ = 0, widestWorkgroup_ = 0;
  bool hasWideAtomics_ = false, hasClock_ = false, requiresSubgroupSize_ = false;
  SubgroupSizes subgroups_;
  VkDriverId driverId_ = {};
  std::uint64_t largestBuffer_ = 0;
  bool draws_ = false, shows_ = false, presents_ = false;
  QueueRoles roles_;
  VkDevice device_ = VK_NULL_HANDLE;
  bool owns_ = true;
  VolkDeviceTable table_{};
  PipelineStore pipelines_;
  std::unique_ptr<Queue> latency_, throughput_, background_, window_;
  std::atomic<std::uint64_t> allocated_ = 0;
  std::atomic<int> urgent_ = 0;
};

/// The GPUs of this machine, in the loader's order.
std::vector<GpuDescription> describeGpus(const Instance& instance);

}  // namespace palpate
