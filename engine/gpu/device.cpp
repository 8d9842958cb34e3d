#include "engine/gpu/device.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <thread>

#include "engine/gpu/device_lookup.hpp"
#include "engine/gpu/host_device.hpp"

namespace palpate {

namespace {

bool hasExtension(VkPhysicalDevice device, const char* name) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
  return std::ranges::any_of(extensions, [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

// Index of the GPU selected by the options; it has all required features.
std::size_t choose(const Instance& instance, const std::vector<GpuDescription>& gpus, std::string selector) {
  if (const char* wanted = std::getenv("PALPATE_GPU"); selector.empty() && wanted) selector = wanted;
  const std::size_t chosen = chooseGpu(gpus, selector);
  requireFeatures(requiredFeatures(instance.physicalDevices()[chosen]), gpus[chosen].name);
  return chosen;
}

// `families` must outlive the result.
std::vector<VkDeviceQueueCreateInfo> queueInfos(std::span<const FamilyQueues> families, bool globalPriority) {
  static constexpr VkDeviceQueueGlobalPriorityCreateInfoKHR kHigh{
      .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_GLOBAL_PRIORITY_CREATE_INFO_KHR,
      .pNext = nullptr,
      .globalPriority = VK_QUEUE_GLOBAL_PRIORITY_HIGH_KHR};
  std::vector<VkDeviceQueueCreateInfo> queues;
  queues.reserve(families.size());
  for (const FamilyQueues& each : families)
    queues.push_back({.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                      .pNext = globalPriority && each.high ? &kHigh : nullptr,
                      .flags = 0,
                      .queueFamilyIndex = each.family,
                      .queueCount = static_cast<std::uint32_t>(each.priorities.size()),
                      .pQueuePriorities = each.priorities.data()});
  return queues;
}

/// Features in the chain of structs that Vulkan takes.
struct FeatureChain {
  explicit FeatureChain(bool clocks) {
    if (clocks) v13.pNext = &clock;
  }
  FeatureChain(const FeatureChain&) = delete;
  FeatureChain& operator=(const FeatureChain&) = delete;

  VkPhysicalDeviceShaderClockFeaturesKHR clock{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_CLOCK_FEATURES_KHR};
  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &v13};
  VkPhysicalDeviceFeatures2 all{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};
};

// Selects the features that are enabled on every GPU.
void enable(const FeatureChain& available, Validation validation, FeatureChain& enabled) {
  enabled.clock.shaderSubgroupClock = available.clock.shaderSubgroupClock;
  enabled.clock.shaderDeviceClock = available.clock.shaderDeviceClock;
  enabled.v13.synchronization2 = VK_TRUE;
  enabled.v13.computeFullSubgroups = VK_TRUE;
  enabled.v13.subgroupSizeControl = available.v13.subgroupSizeControl;
  enabled.v12.bufferDeviceAddress = VK_TRUE;
  enabled.v12.scalarBlockLayout = VK_TRUE;
  if (validation != Validation::full) return;
  // GPU-assisted validation instruments the shaders and needs these features.
  VkPhysicalDeviceFeatures& features = enabled.all.features;
  features.fragmentStoresAndAtomics = available.all.features.fragmentStoresAndAtomics;
  features.vertexPipelineStoresAndAtomics = available.all.features.vertexPipelineStoresAndAtomics;
  features.shaderInt64 = available.all.features.shaderInt64;
}

}  // namespace

std::vector<VkQueueFamilyProperties> queueFamiliesOf(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return families;
}

bool canMakeSwapchains(VkPhysicalDevice device) { return hasExtension(device, VK_KHR_SWAPCHAIN_EXTENSION_NAME); }

std::vector<GpuDescription> describeGpus(const Instance& instance) {
  std::vector<GpuDescription> gpus;
  for (const VkPhysicalDevice device : instance.physicalDevices()) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device, &properties);
    gpus.push_back({properties.deviceName, properties.deviceType});
  }
  return gpus;
}

GpuDescription gpuFor(const DeviceOptions& options) {
  const Instance instance(Validation::off);
  const auto gpus = describeGpus(instance);
  return gpus[choose(instance, gpus, options.gpu)];
}

bool hasRealGpu(const DeviceOptions& options) {
  try {
    return gpuFor(options).type != VK_PHYSICAL_DEVICE_TYPE_CPU;
  } catch (const GpuError&) {
    if (!options.gpu.empty()) throw;
    return false;
  }
}

std::vector<GpuDescription> gpusHere() {
  try {
    return describeGpus(Instance(Validation::off));
  } catch (const GpuError&) {
    return {};
  }
}

Device::Device(const DeviceOptions& options)
    : instance_(std::make_unique<Instance>(options.validation, options.windowExtensions)),
      shows_(options.shows),
      presents_(!options.windowExtensions.empty()) {
  const auto gpus = describeGpus(*instance_);
  physical_ = instance_->physicalDevices()[choose(*instance_, gpus, options.gpu)];
  readProperties();
  createLogicalDevice(options);
}

Device::Device(const HostDevice& host) {
  requireHandles(host);
  instance_ = std::make_unique<Instance>(host);
  physical_ = host.physical;
  owns_ = false;
  readProperties();
  const auto families = queueFamiliesOf(physical_);
  requireAdoptable(host, requiredFeatures(physical_), families, name_);
  roles_ = rolesOf(host, families);
  device_ = host.device;
  takeUp(featuresIn(*host.features));
  volkLoadDeviceTable(&table_, device_);
  const auto lent = [&](const HostQueue& queue) { return queue.handle ? queue.handle : host.throughput.handle; };
  createQueues({lent(host.latency), lent(host.throughput), lent(host.background)},
               [&](VkQueue handle) { return std::make_shared<SharedQueue>(handle, host.lock, host.unlock); });
}

void Device::readProperties() {
  VkPhysicalDeviceMaintenance3Properties allocation{.sType =
                                                        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
  VkPhysicalDeviceVulkan13Properties v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES,
                                         .pNext = &allocation};
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES, .pNext = &v13};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
  vkGetPhysicalDeviceProperties2(physical_, &properties);
  properties_ = properties.properties;
  name_ = properties_.deviceName;
  driverId_ = driver.driverID;
  largestBuffer_ = std::min(v13.maxBufferSize, allocation.maxMemoryAllocationSize);
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
}

void Device::createLogicalDevice(const DeviceOptions& options) {
  const auto roles = chooseQueues(queueFamiliesOf(physical_), options.queues);
  if (!roles) throw GpuError("{} has no compute queue; choose another GPU", name_);
  roles_ = *roles;

  FeatureChain available(hasExtension(physical_, VK_KHR_SHADER_CLOCK_EXTENSION_NAME));
  vkGetPhysicalDeviceFeatures2(physical_, &available.all);
  takeUp(featuresIn(available.all), options.subgroupSize);
  FeatureChain enabled(hasClock_);
  enable(available, instance_->validation(), enabled);
  enabled.v13.dynamicRendering = enabled.all.features.largePoints = draws_;
  enabled.v12.shaderBufferInt64Atomics = hasWideAtomics_;
  if (hasWideAtomics_) enabled.all.features.shaderInt64 = VK_TRUE;

  const bool globalPriority = hasExtension(physical_, VK_KHR_GLOBAL_PRIORITY_EXTENSION_NAME);
  std::vector<const char*> extensions;
  if (globalPriority) extensions.push_back(VK_KHR_GLOBAL_PRIORITY_EXTENSION_NAME);
  if (hasClock_) extensions.push_back(VK_KHR_SHADER_CLOCK_EXTENSION_NAME);
  // A device that implements only a subset of Vulkan, as on top of Metal, requires this extension to be enabled.
  constexpr const char* kPortabilitySubset = "VK_KHR_portability_subset";
  if (hasExtension(physical_, kPortabilitySubset)) extensions.push_back(kPortabilitySubset);
  if (presents_ && canMakeSwapchains(physical_)) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  const std::vector<FamilyQueues> families = queuesFor(roles_, options.queues);
  std::vector<VkDeviceQueueCreateInfo> queues = queueInfos(families, globalPriority);
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = &enabled.all,
                                .flags = 0,
                                .queueCreateInfoCount = static_cast<std::uint32_t>(queues.size()),
                                .pQueueCreateInfos = queues.data(),
                                .enabledLayerCount = 0,
                                .ppEnabledLayerNames = nullptr,
                                .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                                .ppEnabledExtensionNames = extensions.data(),
                                .pEnabledFeatures = nullptr};
  VkResult result = vkCreateDevice(physical_, &info, nullptr, &device_);
  if (result != VK_SUCCESS && globalPriority) {  // high priority may need a right that this user lacks
    for (VkDeviceQueueCreateInfo& each : queues) each.pNext = nullptr;
    result = vkCreateDevice(physical_, &info, nullptr, &device_);
  }
  check(result, "vkCreateDevice");
  volkLoadDeviceTable(&table_, device_);
  const auto handleOf = [&](const QueueChoice& choice) {
    VkQueue handle = VK_NULL_HANDLE;
    table_.vkGetDeviceQueue(device_, choice.family, choice.index, &handle);
    return handle;
  };
  try {
    createQueues({handleOf(roles_.latency), handleOf(roles_.throughput), handleOf(roles_.background)},
                 [](VkQueue handle) { return std::make_shared<SharedQueue>(handle); });
  } catch (...) {
    destroyQueues();
    table_.vkDestroyDevice(device_, nullptr);
    throw;
  }
}

std::vector<std::uint32_t> Device::subgroupSizes() const {
  return usableSubgroupSizes(subgroups_, properties_.vendorID);
}

void Device::takeUp(const Features& enabled, std::uint32_t subgroupSize) {
  // GPU-assisted validation of a draw hangs NVIDIA's driver (580.159 with the layer of Debian 12).
  const bool stops = instance_->validation() == Validation::full && driverId_ == VK_DRIVER_ID_NVIDIA_PROPRIETARY;
  draws_ = roles_.draws && enabled.dynamicRendering && enabled.largePoints && !stops;
  hasWideAtomics_ = enabled.bufferInt64Atomics && enabled.int64;
  hasClock_ = enabled.clocks;
  subgroups_ = subgroupSizesOf(physical_);
  subgroups_.canRequire = subgroups_.canRequire && enabled.subgroupSizeControl;
  const std::vector<std::uint32_t> sizes = subgroupSizes();
  if (subgroupSize > 0 && !std::ranges::count(sizes, subgroupSize))
    throw GpuError("{} has no subgroups of {}, but of {}", name_, subgroupSize, fmt::join(sizes, ", "));
  subgroupSize_ = subgroupSize > 0 ? subgroupSize : sizes.front();
  requiresSubgroupSize_ = subgroups_.canRequire && subgroups_.min < subgroups_.max;
  const VkPhysicalDeviceLimits& limits = properties_.limits;
  widestWorkgroup_ = std::min(limits.maxComputeWorkGroupInvocations, limits.maxComputeWorkGroupSize[0]);
  if (requiresSubgroupSize_)
    widestWorkgroup_ = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(widestWorkgroup_, std::uint64_t{subgroupSize_} * subgroups_.mostInWorkgroup));
}

void Device::createQueues(const QueueHandles& handles, const MakeQueue& make) {
  std::map<VkQueue, std::shared_ptr<SharedQueue>> queues;  // roles with the same handle share its lock
  const auto queue = [&](VkQueue handle, const QueueChoice& choice, QueuePolicy policy) {
    auto& shared = queues[handle];
    if (!shared) shared = make(handle);
    return std::make_unique<Queue>(*this, shared, choice.family, policy);
  };
  throughput_ = queue(handles.throughput, roles_.throughput, QueuePolicy::throughput);
  latency_ = queue(handles.latency, roles_.latency, QueuePolicy::latency);
  background_ = queue(handles.background, roles_.background, QueuePolicy::background);
  if (shows_) window_ = queue(handles.throughput, roles_.throughput, QueuePolicy::throughput);
}

void Device::destroyQueues() {
  latency_.reset();
  throughput_.reset();
  background_.reset();
  window_.reset();
}

Device::~Device() {
  if (!device_) return;
  try {
    waitIdle();
  } catch (const GpuError&) {  // the device is lost, so nothing runs on it
  }
  destroyQueues();
  pipelines_.destroyAll(*this);
  if (owns_) table_.vkDestroyDevice(device_, nullptr);
}

std::uint64_t Device::timestampMask(std::uint32_t queueFamily) const {
  const std::uint32_t bits = queueFamiliesOf(physical_).at(queueFamily).timestampValidBits;
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

std::uint64_t Device::ownMemory() const {
  std::uint64_t bytes = 0;
  for (std::uint32_t i = 0; i < memory_.memoryHeapCount; ++i)
    if (memory_.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) bytes += memory_.memoryHeaps[i].size;
  return bytes;
}

// vkDeviceWaitIdle() requires that the host program submits nothing at the same time, and would wait for its work.
void Device::waitIdle() const {
  if (owns_) return check(table_.vkDeviceWaitIdle(device_), "vkDeviceWaitIdle");
  for (const Queue* queue : {latency_.get(), throughput_.get(), background_.get()}) queue->finish();
}

Wait Device::defaultWait() const {
  return isCpu() || std::thread::hardware_concurrency() <= 2 ? Wait::block : Wait::spin;
}

void Device::nameObject(VkObjectType type, std::uint64_t object, const std::string& name) const {
  if (!instance_->hasDebugUtils()) return;
  const VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                           .pNext = nullptr,
                                           .objectType = type,
                                           .objectHandle = object,
                                           .pObjectName = name.c_str()};
  vkSetDebugUtilsObjectNameEXT(device_, &info);
}

}  // namespace palpate
