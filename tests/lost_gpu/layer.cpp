// A Vulkan layer that simulates the loss of a GPU: it sits between a program and its driver, forwards all calls, and
// from a given submission on returns VK_ERROR_DEVICE_LOST, so that the program's real code runs to the last call. The
// submission is given by PALPATE_LOST_GPU ("submit:300", "fence:300") or by palpateLoseGpu(). Other modes keep the
// device: "count" reports the number of submissions, and the pipelines by their required subgroup size, at the end (so
// does PALPATE_COUNT_PIPELINES in any mode); "display" simulates NVIDIA's driver on an X server
// without its extension, which crashes on a query about a surface; "coarse" says that a timestamp counts microseconds;
// "minimum" reduces the GPU to the minimum of Vulkan, "minimum:NAME=VALUE,..." with the given exceptions
// (made_up_gpu.hpp).
//
// Loader and layer interface: LoaderLayerInterface.md of the Vulkan loader, version 2.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "tests/lost_gpu/made_up_gpu.hpp"

namespace {

constexpr long kNever = std::numeric_limits<long>::max();

// One instance and one device at a time, which is all that the program creates.
PFN_vkGetPhysicalDeviceProperties2 nextProperties = nullptr;
PFN_vkGetPhysicalDeviceProperties nextFirstProperties = nullptr;
PFN_vkGetPhysicalDeviceFeatures2 nextFeatures = nullptr;
PFN_vkGetPhysicalDeviceFeatures nextFirstFeatures = nullptr;
PFN_vkGetPhysicalDeviceQueueFamilyProperties nextFamilies = nullptr;
PFN_vkEnumerateDeviceExtensionProperties nextExtensions = nullptr;
PFN_vkGetInstanceProcAddr nextInstanceProc = nullptr;
PFN_vkGetDeviceProcAddr nextDeviceProc = nullptr;
PFN_vkCreateComputePipelines nextPipelines = nullptr;
PFN_vkQueueSubmit2 nextSubmit = nullptr;
PFN_vkGetFenceStatus nextFenceStatus = nullptr;
PFN_vkWaitForFences nextWaitForFences = nullptr;
PFN_vkDeviceWaitIdle nextWaitIdle = nullptr;

std::atomic<long> submissionsLeft = kNever;
std::atomic<bool> failsAtSubmit = false;  // else that submission hangs, and its fence reports the loss
std::atomic<bool> lost = false;

struct Tally {
  ~Tally() {
    if (says) std::fprintf(stderr, "%ld submissions\n", submissions.load());
    if (says)
      for (const auto& [size, count] : pipelines)
        std::fprintf(stderr, "%d pipelines of subgroups of %u\n", count, size);
  }
  bool says = false;
  std::atomic<long> submissions = 0;
  std::mutex guard;
  std::map<std::uint32_t, int> pipelines;  // by the required subgroup size; 0: none is required
} tally;

void readEnvironment() {
  lost = false;
  submissionsLeft = kNever;
  const char* text = std::getenv("PALPATE_LOST_GPU");
  if (!text) return;
  tally.says = std::strcmp(text, "count") == 0 || std::getenv("PALPATE_COUNT_PIPELINES");
  failsAtSubmit = std::strncmp(text, "submit:", 7) == 0;
  if (failsAtSubmit || std::strncmp(text, "fence:", 6) == 0) submissionsLeft = std::atol(std::strchr(text, ':') + 1);
}

VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* infos, VkFence fence) {
  if (lost) return VK_ERROR_DEVICE_LOST;
  ++tally.submissions;
  if (submissionsLeft != kNever && --submissionsLeft < 0) {
    lost = true;
    return failsAtSubmit ? VK_ERROR_DEVICE_LOST : VK_SUCCESS;  // the hung submission never runs
  }
  return nextSubmit(queue, count, infos, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL createPipelines(VkDevice device, VkPipelineCache cache, std::uint32_t count,
                                               const VkComputePipelineCreateInfo* infos,
                                               const VkAllocationCallbacks* allocator, VkPipeline* made) {
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t size = 0;
    for (auto* each = static_cast<const VkBaseInStructure*>(infos[i].stage.pNext); each; each = each->pNext)
      if (each->sType == VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_REQUIRED_SUBGROUP_SIZE_CREATE_INFO)
        size = reinterpret_cast<const VkPipelineShaderStageRequiredSubgroupSizeCreateInfo*>(each)->requiredSubgroupSize;
    const std::scoped_lock hold(tally.guard);
    ++tally.pipelines[size];
  }
  return nextPipelines(device, cache, count, infos, allocator, made);
}

VKAPI_ATTR VkResult VKAPI_CALL fenceStatus(VkDevice device, VkFence fence) {
  return lost ? VK_ERROR_DEVICE_LOST : nextFenceStatus(device, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL waitForFences(VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all,
                                             std::uint64_t timeout) {
  return lost ? VK_ERROR_DEVICE_LOST : nextWaitForFences(device, count, fences, all, timeout);
}

VKAPI_ATTR VkResult VKAPI_CALL waitIdle(VkDevice device) {
  const VkResult result = nextWaitIdle(device);  // a software driver may still be working
  return lost ? VK_ERROR_DEVICE_LOST : result;
}

bool isMode(const char* mode) {
  const char* text = std::getenv("PALPATE_LOST_GPU");
  return text && std::strcmp(text, mode) == 0;
}

/// Read again for each instance.
std::optional<madeup::Gpu> madeUp;

void readMadeUp() {
  constexpr std::string_view kMode = "minimum";
  const char* text = std::getenv("PALPATE_LOST_GPU");
  const std::string_view asked = text ? text : "";
  madeUp.reset();
  if (asked == kMode) madeUp.emplace("");
  if (asked.starts_with("minimum:")) madeUp.emplace(std::string(asked.substr(kMode.size() + 1)));
}

VKAPI_ATTR void VKAPI_CALL madeUpFirstProperties(VkPhysicalDevice gpu, VkPhysicalDeviceProperties* told) {
  nextFirstProperties(gpu, told);
  madeUp->amend(*told);
}

VKAPI_ATTR void VKAPI_CALL madeUpProperties(VkPhysicalDevice gpu, VkPhysicalDeviceProperties2* told) {
  nextProperties(gpu, told);
  madeUp->amend(*told);
}

VKAPI_ATTR void VKAPI_CALL madeUpFirstFeatures(VkPhysicalDevice gpu, VkPhysicalDeviceFeatures* told) {
  nextFirstFeatures(gpu, told);
  madeUp->amend(*told);
}

VKAPI_ATTR void VKAPI_CALL madeUpFeatures(VkPhysicalDevice gpu, VkPhysicalDeviceFeatures2* told) {
  nextFeatures(gpu, told);
  madeUp->amend(*told);
}

VKAPI_ATTR void VKAPI_CALL madeUpFamilies(VkPhysicalDevice gpu, std::uint32_t* count, VkQueueFamilyProperties* told) {
  nextFamilies(gpu, count, told);
  for (std::uint32_t i = 0; told && i < *count; ++i) madeUp->amend(told[i]);
}

VKAPI_ATTR VkResult VKAPI_CALL madeUpExtensions(VkPhysicalDevice gpu, const char* layer, std::uint32_t* count,
                                                VkExtensionProperties* told) {
  if (layer) return nextExtensions(gpu, layer, count, told);
  const std::uint32_t room = *count;
  *count = 1;
  if (!told) return VK_SUCCESS;
  if (room < 1) return VK_INCOMPLETE;
  told[0] = {};
  std::strcpy(told[0].extensionName, madeup::Gpu::kExtension);
  told[0].specVersion = 1;
  return VK_SUCCESS;
}

// Instance commands of a made-up GPU.
PFN_vkVoidFunction madeUpCommand(std::string_view wanted) {
  if (wanted == "vkGetPhysicalDeviceProperties") return reinterpret_cast<PFN_vkVoidFunction>(madeUpFirstProperties);
  if (wanted.starts_with("vkGetPhysicalDeviceProperties2"))
    return reinterpret_cast<PFN_vkVoidFunction>(madeUpProperties);
  if (wanted == "vkGetPhysicalDeviceFeatures") return reinterpret_cast<PFN_vkVoidFunction>(madeUpFirstFeatures);
  if (wanted.starts_with("vkGetPhysicalDeviceFeatures2")) return reinterpret_cast<PFN_vkVoidFunction>(madeUpFeatures);
  if (wanted == "vkGetPhysicalDeviceQueueFamilyProperties") return reinterpret_cast<PFN_vkVoidFunction>(madeUpFamilies);
  if (wanted == "vkEnumerateDeviceExtensionProperties") return reinterpret_cast<PFN_vkVoidFunction>(madeUpExtensions);
  return nullptr;
}

VKAPI_ATTR void VKAPI_CALL properties(VkPhysicalDevice gpu, VkPhysicalDeviceProperties2* told) {
  nextProperties(gpu, told);
  for (auto* each = static_cast<VkBaseOutStructure*>(told->pNext); each; each = each->pNext)
    if (each->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES)
      reinterpret_cast<VkPhysicalDeviceDriverProperties*>(each)->driverID = VK_DRIVER_ID_NVIDIA_PROPRIETARY;
}

VKAPI_ATTR void VKAPI_CALL coarseProperties(VkPhysicalDevice gpu, VkPhysicalDeviceProperties2* told) {
  nextProperties(gpu, told);
  told->properties.limits.timestampPeriod = 1000;
}

VKAPI_ATTR VkResult VKAPI_CALL askedAboutSurface() {
  std::fprintf(stderr, "the driver was queried about a surface\n");
  std::abort();
}

// Instance commands of the "display" mode.
PFN_vkVoidFunction surfaceCommand(std::string_view wanted) {
  if (wanted == "vkGetPhysicalDeviceProperties2") return reinterpret_cast<PFN_vkVoidFunction>(properties);
  const bool asks = wanted.starts_with("vkGetPhysicalDeviceSurface") || wanted.ends_with("PresentationSupportKHR");
  return asks ? reinterpret_cast<PFN_vkVoidFunction>(askedAboutSurface) : nullptr;
}

template <class Info>
Info* linkInfo(const void* chain, VkStructureType type) {
  auto* info = const_cast<Info*>(static_cast<const Info*>(chain));
  while (info && !(info->sType == type && info->function == VK_LAYER_LINK_INFO))
    info = const_cast<Info*>(static_cast<const Info*>(info->pNext));
  return info;
}

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                              VkInstance* instance) {
  auto* link = linkInfo<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (!link) return VK_ERROR_INITIALIZATION_FAILED;
  nextInstanceProc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  readMadeUp();
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(nextInstanceProc(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, instance);
  // Queried now: later the loader's answer would start at the first layer again.
  if (result != VK_SUCCESS) return result;
  const auto get = [&](auto& next, const char* name) {
    next = reinterpret_cast<std::remove_reference_t<decltype(next)>>(nextInstanceProc(*instance, name));
  };
  get(nextProperties, "vkGetPhysicalDeviceProperties2");
  get(nextFirstProperties, "vkGetPhysicalDeviceProperties");
  get(nextFeatures, "vkGetPhysicalDeviceFeatures2");
  get(nextFirstFeatures, "vkGetPhysicalDeviceFeatures");
  get(nextFamilies, "vkGetPhysicalDeviceQueueFamilyProperties");
  get(nextExtensions, "vkEnumerateDeviceExtensionProperties");
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice gpu, const VkDeviceCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkDevice* device) {
  auto* link = linkInfo<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (!link) return VK_ERROR_INITIALIZATION_FAILED;
  const auto instanceProc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  nextDeviceProc = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(instanceProc(VK_NULL_HANDLE, "vkCreateDevice"));
  VkDeviceCreateInfo asked = *info;
  std::vector<const char*> extensions;
  if (madeUp) {
    if (!madeUp->accepts(*info, extensions)) return VK_ERROR_INITIALIZATION_FAILED;
    asked.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    asked.ppEnabledExtensionNames = extensions.data();
  }
  const VkResult result = create(gpu, &asked, allocator, device);
  if (result != VK_SUCCESS) return result;
  const auto get = [&](const char* name) { return nextDeviceProc(*device, name); };
  nextPipelines = reinterpret_cast<PFN_vkCreateComputePipelines>(get("vkCreateComputePipelines"));
  nextSubmit = reinterpret_cast<PFN_vkQueueSubmit2>(get("vkQueueSubmit2"));
  nextFenceStatus = reinterpret_cast<PFN_vkGetFenceStatus>(get("vkGetFenceStatus"));
  nextWaitForFences = reinterpret_cast<PFN_vkWaitForFences>(get("vkWaitForFences"));
  nextWaitIdle = reinterpret_cast<PFN_vkDeviceWaitIdle>(get("vkDeviceWaitIdle"));
  readEnvironment();
  return VK_SUCCESS;
}

PFN_vkVoidFunction deviceCommand(const char* name) {
  const std::string_view wanted = name;
  if (wanted == "vkCreateComputePipelines") return reinterpret_cast<PFN_vkVoidFunction>(createPipelines);
  if (wanted == "vkQueueSubmit2") return reinterpret_cast<PFN_vkVoidFunction>(submit);
  if (wanted == "vkGetFenceStatus") return reinterpret_cast<PFN_vkVoidFunction>(fenceStatus);
  if (wanted == "vkWaitForFences") return reinterpret_cast<PFN_vkVoidFunction>(waitForFences);
  if (wanted == "vkDeviceWaitIdle") return reinterpret_cast<PFN_vkVoidFunction>(waitIdle);
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL deviceProc(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(deviceProc);
  const auto own = deviceCommand(name);
  return own ? own : nextDeviceProc(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instanceProc(VkInstance instance, const char* name) {
  const std::string_view wanted = name;
  if (wanted == "vkGetInstanceProcAddr") return reinterpret_cast<PFN_vkVoidFunction>(instanceProc);
  if (wanted == "vkGetDeviceProcAddr") return reinterpret_cast<PFN_vkVoidFunction>(deviceProc);
  if (wanted == "vkCreateInstance") return reinterpret_cast<PFN_vkVoidFunction>(createInstance);
  if (wanted == "vkCreateDevice") return reinterpret_cast<PFN_vkVoidFunction>(createDevice);
  if (const auto own = deviceCommand(name)) return own;
  if (const auto own = madeUp ? madeUpCommand(wanted) : nullptr) return own;
  if (const auto own = isMode("display") ? surfaceCommand(wanted) : nullptr) return own;
  if (isMode("coarse") && wanted == "vkGetPhysicalDeviceProperties2")
    return reinterpret_cast<PFN_vkVoidFunction>(coarseProperties);
  return nextInstanceProc ? nextInstanceProc(instance, name) : nullptr;
}

}  // namespace

extern "C" {

/// Loses the GPU of this process at its next submission (`atSubmit`: that call fails; otherwise it hangs).
VK_LAYER_EXPORT void palpateLoseGpu(bool atSubmit) {
  failsAtSubmit = atSubmit;
  submissionsLeft = 0;
}

VK_LAYER_EXPORT VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
  if (version->loaderLayerInterfaceVersion < 2) return VK_ERROR_INITIALIZATION_FAILED;
  version->loaderLayerInterfaceVersion = 2;
  version->pfnGetInstanceProcAddr = instanceProc;
  version->pfnGetDeviceProcAddr = deviceProc;
  version->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}

}  // extern "C"
