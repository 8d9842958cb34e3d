#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "engine/gpu/compute_pipeline.hpp"
#include "engine/gpu/device_choice.hpp"
#include "engine/gpu/instance.hpp"
#include "engine/gpu/queue.hpp"

namespace palpate {

struct Features;
struct HostDevice;

struct DeviceOptions {
  std::string gpu;  ///< number or part of a name; empty: PALPATE_GPU, else the best there is
  Validation validation = Validation::off;
  QueueArrangement queues = QueueArrangement::separate;
  bool shows = false;  ///< pictures in a window: it has a queue for the thread that shows them
  /// Of the instance, for a device that may present them to the window system itself.
  std::vector<std::string> windowExtensions = {};
};

std::vector<VkQueueFamilyProperties> queueFamiliesOf(VkPhysicalDevice device);
bool canMakeSwapchains(VkPhysicalDevice device);

/// A GPU in use: its logical device, its queues by their policies and its limits. Everything made from it must go
/// before it.
class Device {
 public:
  explicit Device(const DeviceOptions& options);
  /// On a device that another program has made, beside its own use of it. What that made stays when this goes: of it
  /// only what came after is destroyed. Throws GpuError that names what the device lacks.
  explicit Device(const HostDevice& host);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkDevice handle() const { return device_; }
  VkPhysicalDevice physical() const { return physical_; }
  const VolkDeviceTable& vk() const { return table_; }
  const std::string& name() const { return name_; }
  Instance& instance() { return *instance_; }

  /// For short work that somebody waits for: compute-only and of high priority where the device has such a family.
  Queue& latencyQueue() { return *latency_; }
  /// For long work, which gives way; with graphics where the device has any.
  Queue& throughputQueue() { return *throughput_; }
  /// A second way to the queue of throughput, for the thread that shows pictures; only on a device made for one.
  Queue& window() { return *window_; }
  /// For work that nobody waits for and that must not hold up latency. Used by the thread that uses latencyQueue().
  Queue& backgroundQueue() { return *background_; }
  const QueueRoles& roles() const { return roles_; }
  PipelineStore& pipelines() { return pipelines_; }

  bool isCpu() const { return properties_.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
  const VkPhysicalDeviceProperties& properties() const { return properties_; }
  std::uint32_t subgroupSize() const { return subgroupSize_; }
  /// Whether shaders may add to 64 bits of a buffer at once.
  bool hasWideAtomics() const { return hasWideAtomics_; }
  /// Whether shaders may read a clock that all of them share.
  bool hasClock() const { return hasClock_; }
  VkDriverId driverId() const { return driverId_; }
  /// Whether the queue of throughput can draw into images (CommandList::draw), points of any size among it.
  bool draws() const { return draws_; }
  /// Side of the largest point that a draw makes, pixels.
  float largestPoint_px() const { return properties_.limits.pointSizeRange[1]; }
  /// Bytes that one buffer may have.
  std::uint64_t largestBuffer() const { return largestBuffer_; }
  /// Nanoseconds per tick of the GPU's clock.
  double timestampPeriod_ns() const { return properties_.limits.timestampPeriod; }
  /// The bits that a queue family's timestamps count in; 0 where it keeps none.
  std::uint64_t timestampMask(std::uint32_t queueFamily) const;
  const VkPhysicalDeviceMemoryProperties& memory() const { return memory_; }
  /// Bytes of all heaps of the GPU's own memory.
  std::uint64_t ownMemory() const;
  /// Bytes of memory that buffers hold at present, of every kind.
  std::uint64_t allocatedBytes() const { return allocated_.load(std::memory_order_relaxed); }
  /// Whether somebody works on it who waits for each answer: the queue of throughput then gives way (CommandList).
  bool hasUrgentWork() const { return urgent_.load(std::memory_order_relaxed) > 0; }
  /// Called by those who do, as they come (1) and go (-1).
  void noteUrgentWork(int change) { urgent_.fetch_add(change, std::memory_order_relaxed); }
  /// Called by buffers as they come and go.
  void noteAllocation(std::uint64_t bytes) { allocated_.fetch_add(bytes, std::memory_order_relaxed); }
  void noteRelease(std::uint64_t bytes) { allocated_.fetch_sub(bytes, std::memory_order_relaxed); }
  /// Spinning where the driver has cores of its own, blocking where it shares ours.
  Wait defaultWait() const;

  void check(VkResult result, std::string_view call) const { checkVk(result, call, name_); }
  /// For all that was submitted through this; on a device of one's own for whatever runs on it.
  void waitIdle() const;
  /// Names a Vulkan object for debuggers and validation messages.
  void nameObject(VkObjectType type, std::uint64_t handle, const std::string& name) const;

 private:
  void readProperties();
  void createLogicalDevice(QueueArrangement arrangement);
  void takeUp(const Features& enabled);
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
  std::uint32_t subgroupSize_ = 0;
  bool hasWideAtomics_ = false, hasClock_ = false;
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
