#include "engine/gpu/device.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <map>
#include <thread>

#include "engine/gpu/device_lookup.hpp"

namespace palpate {

namespace {

bool hasExtension(VkPhysicalDevice device, const char* name) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
  return std::ranges::any_of(extensions, [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

// The number of the GPU that the options ask for; it can do what palpate needs.
std::size_t choose(const Instance& instance, const std::vector<GpuDescription>& gpus, std::string selector) {
  if (const char* wanted = std::getenv("PALPATE_GPU"); selector.empty() && wanted) selector = wanted;
  const std::size_t chosen = chooseGpu(gpus, selector);
  requireFeatures(requiredFeatures(instance.physicalDevices()[chosen]), gpus[chosen].name);
  return chosen;
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
  const Instance instance(false);
  const auto gpus = describeGpus(instance);
  return gpus[choose(instance, gpus, options.gpu)];
}

Device::Device(const DeviceOptions& options)
    : instance_(std::make_unique<Instance>(options.validate, options.windowExtensions)),
      shows_(options.shows),
      presents_(!options.windowExtensions.empty()) {
  const auto gpus = describeGpus(*instance_);
  const std::size_t chosen = choose(*instance_, gpus, options.gpu);
  physical_ = instance_->physicalDevices()[chosen];
  name_ = gpus[chosen].name;

  VkPhysicalDeviceMaintenance3Properties allocation{.sType =
                                                        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
  VkPhysicalDeviceVulkan13Properties v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES,
                                         .pNext = &allocation};
  VkPhysicalDeviceSubgroupProperties subgroup{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
                                              .pNext = &v13};
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
                                          .pNext = &subgroup};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
  vkGetPhysicalDeviceProperties2(physical_, &properties);
  properties_ = properties.properties;
  driverId_ = driver.driverID;
  subgroupSize_ = subgroup.subgroupSize;
  largestBuffer_ = std::min(v13.maxBufferSize, allocation.maxMemoryAllocationSize);
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
  createLogicalDevice(options.queues);
}

void Device::createLogicalDevice(QueueArrangement arrangement) {
  const auto roles = chooseQueues(queueFamiliesOf(physical_), arrangement);
  if (!roles) throw GpuError("{} has no queue that computes; choose another GPU with --gpu", name_);
  roles_ = *roles;

  const bool globalPriority = hasExtension(physical_, VK_KHR_GLOBAL_PRIORITY_EXTENSION_NAME);
  const VkDeviceQueueGlobalPriorityCreateInfoKHR high{
      .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_GLOBAL_PRIORITY_CREATE_INFO_KHR,
      .pNext = nullptr,
      .globalPriority = VK_QUEUE_GLOBAL_PRIORITY_HIGH_KHR};
  const std::vector<FamilyQueues> wanted = queuesFor(roles_, arrangement);
  std::vector<VkDeviceQueueCreateInfo> queues;
  for (const FamilyQueues& each : wanted)
    queues.push_back({.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                      .pNext = globalPriority && each.high ? &high : nullptr,
                      .flags = 0,
                      .queueFamilyIndex = each.family,
                      .queueCount = static_cast<std::uint32_t>(each.priorities.size()),
                      .pQueuePriorities = each.priorities.data()});

  const bool clockExtension = hasExtension(physical_, VK_KHR_SHADER_CLOCK_EXTENSION_NAME);
  VkPhysicalDeviceShaderClockFeaturesKHR clock{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_CLOCK_FEATURES_KHR};
  VkPhysicalDeviceVulkan13Features available13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                               .pNext = clockExtension ? &clock : nullptr};
  VkPhysicalDeviceVulkan12Features available12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                               .pNext = &available13};
  VkPhysicalDeviceFeatures2 availables{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &available12};
  vkGetPhysicalDeviceFeatures2(physical_, &availables);
  const VkPhysicalDeviceFeatures& available = availables.features;
  // GPU-assisted validation of a draw stops NVIDIA's driver (580.159 with the layer of Debian 12) for good.
  const bool stops = instance_->validates() && driverId_ == VK_DRIVER_ID_NVIDIA_PROPRIETARY;
  draws_ = roles_.draws && available13.dynamicRendering && available.largePoints && !stops;
  hasWideAtomics_ = available12.shaderBufferInt64Atomics == VK_TRUE && available.shaderInt64 == VK_TRUE;
  hasClock_ = clock.shaderDeviceClock == VK_TRUE;
  clock.pNext = nullptr;

  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                       .pNext = hasClock_ ? &clock : nullptr};
  v13.synchronization2 = VK_TRUE;
  v13.dynamicRendering = draws_;
  v13.computeFullSubgroups = VK_TRUE;
  VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &v13};
  v12.bufferDeviceAddress = VK_TRUE;
  v12.scalarBlockLayout = VK_TRUE;
  v12.shaderBufferInt64Atomics = hasWideAtomics_;
  VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};
  features.features.largePoints = draws_;
  features.features.shaderInt64 = hasWideAtomics_;
  if (instance_->validates()) {
    // GPU-assisted validation instruments the shaders and needs these itself.
    features.features.fragmentStoresAndAtomics = available.fragmentStoresAndAtomics;
    features.features.vertexPipelineStoresAndAtomics = available.vertexPipelineStoresAndAtomics;
    features.features.shaderInt64 = available.shaderInt64;
  }

  std::vector<const char*> extensions;
  if (globalPriority) extensions.push_back(VK_KHR_GLOBAL_PRIORITY_EXTENSION_NAME);
  if (hasClock_) extensions.push_back(VK_KHR_SHADER_CLOCK_EXTENSION_NAME);
  if (presents_ && canMakeSwapchains(physical_)) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = &features,
                                .flags = 0,
                                .queueCreateInfoCount = static_cast<std::uint32_t>(queues.size()),
                                .pQueueCreateInfos = queues.data(),
                                .enabledLayerCount = 0,
                                .ppEnabledLayerNames = nullptr,
                                .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                                .ppEnabledExtensionNames = extensions.data(),
                                .pEnabledFeatures = nullptr};
  VkResult result = vkCreateDevice(physical_, &info, nullptr, &device_);
  if (result != VK_SUCCESS && globalPriority) {  // high priority may want a right that this user lacks: go without
    for (VkDeviceQueueCreateInfo& each : queues) each.pNext = nullptr;
    result = vkCreateDevice(physical_, &info, nullptr, &device_);
  }
  check(result, "vkCreateDevice");
  volkLoadDeviceTable(&table_, device_);
  try {
    createQueues();
  } catch (...) {
    touch_.reset();
    sight_.reset();
    background_.reset();
    window_.reset();
    table_.vkDestroyDevice(device_, nullptr);
    throw;
  }
}

void Device::createQueues() {
  std::map<VkQueue, std::shared_ptr<SharedQueue>> queues;  // roles with one handle share its lock
  const auto queue = [&](const QueueChoice& choice) {
    VkQueue handle = VK_NULL_HANDLE;
    table_.vkGetDeviceQueue(device_, choice.family, choice.index, &handle);
    auto& shared = queues[handle];
    if (!shared) shared = std::make_shared<SharedQueue>();
    shared->handle = handle;
    return std::make_unique<Queue>(*this, shared, choice.family);
  };
  sight_ = queue(roles_.sight);
  touch_ = queue(roles_.touch);
  background_ = queue(roles_.background);
  if (shows_) window_ = queue(roles_.sight);
}

Device::~Device() {
  if (!device_) return;
  table_.vkDeviceWaitIdle(device_);
  touch_.reset();
  sight_.reset();
  background_.reset();
  window_.reset();
  pipelines_.destroyAll(*this);
  table_.vkDestroyDevice(device_, nullptr);
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

void Device::waitIdle() const { check(table_.vkDeviceWaitIdle(device_), "vkDeviceWaitIdle"); }

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
