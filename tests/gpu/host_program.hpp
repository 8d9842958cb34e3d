// A program that creates a device with Vulkan of its own, lends it and continues to use it.
#pragma once

#include <dlfcn.h>
#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <string_view>

#include "engine/gpu/host_device.hpp"
#include "tests/asked_validation.hpp"

namespace palpate {

inline bool validates() { return askedValidation() != Validation::off; }

/// The host program: loads Vulkan, creates a device with one queue, and submits its own work to it. It knows nothing of
/// palpate except the parameters of lend().
class HostProgram {
 public:
  /// `without`: a feature that is not enabled.
  explicit HostProgram(std::string_view without = "") {
    loader_ = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    REQUIRE(loader_);
    getProc_ = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(loader_, "vkGetInstanceProcAddr"));
    makeInstance();
    makeDevice(without);
  }
  ~HostProgram() {
    call<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle")(device_);
    call<PFN_vkDestroyDevice>("vkDestroyDevice")(device_, nullptr);
    if (messenger_)
      call<PFN_vkDestroyDebugUtilsMessengerEXT>("vkDestroyDebugUtilsMessengerEXT")(instance_, messenger_, nullptr);
    call<PFN_vkDestroyInstance>("vkDestroyInstance")(instance_, nullptr);
    CHECK(messages_ == 0);
  }
  HostProgram(const HostProgram&) = delete;
  HostProgram& operator=(const HostProgram&) = delete;

  HostDevice lend() {
    return {.getInstanceProcAddr = getProc_,
            .instance = instance_,
            .apiVersion = VK_API_VERSION_1_3,
            .validation = validates() ? Validation::core : Validation::off,
            .debugUtils = validates(),
            .physical = physical_,
            .device = device_,
            .features = &features_,
            .throughput = {.handle = queue_, .family = family_},
            .latency = {},
            .background = {},
            .lock =
                [this](VkQueue queue) {
                  queueLock_.lock();
                  holds_ += queue == queue_;
                },
            .unlock = [this](VkQueue) { queueLock_.unlock(); }};
  }
  /// How many times palpate has locked the host's queue.
  int holds() const { return holds_; }

  /// Submits its own work, `times` times, and returns whether it was completed.
  bool worksItself(int times) {
    VkCommandPool pool = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkQueryPool queries = VK_NULL_HANDLE;
    const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                           .pNext = nullptr,
                                           .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                           .queueFamilyIndex = family_};
    const VkFenceCreateInfo fenceInfo{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .pNext = nullptr, .flags = 0};
    const VkQueryPoolCreateInfo queryInfo{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                          .pNext = nullptr,
                                          .flags = 0,
                                          .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                          .queryCount = 1,
                                          .pipelineStatistics = 0};
    bool well =
        call<PFN_vkCreateCommandPool>("vkCreateCommandPool")(device_, &poolInfo, nullptr, &pool) == VK_SUCCESS &&
        call<PFN_vkCreateFence>("vkCreateFence")(device_, &fenceInfo, nullptr, &fence) == VK_SUCCESS &&
        call<PFN_vkCreateQueryPool>("vkCreateQueryPool")(device_, &queryInfo, nullptr, &queries) == VK_SUCCESS;
    const VkCommandBufferAllocateInfo allocation{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                 .pNext = nullptr,
                                                 .commandPool = pool,
                                                 .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                 .commandBufferCount = 1};
    well = well && call<PFN_vkAllocateCommandBuffers>("vkAllocateCommandBuffers")(device_, &allocation, &commands) ==
                       VK_SUCCESS;
    for (int i = 0; i < times && well; ++i) {
      const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                           .pNext = nullptr,
                                           .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
                                           .pInheritanceInfo = nullptr};
      call<PFN_vkBeginCommandBuffer>("vkBeginCommandBuffer")(commands, &begin);
      call<PFN_vkCmdResetQueryPool>("vkCmdResetQueryPool")(commands, queries, 0, 1);
      call<PFN_vkCmdWriteTimestamp>("vkCmdWriteTimestamp")(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries, 0);
      call<PFN_vkEndCommandBuffer>("vkEndCommandBuffer")(commands);
      const VkSubmitInfo submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                .pNext = nullptr,
                                .waitSemaphoreCount = 0,
                                .pWaitSemaphores = nullptr,
                                .pWaitDstStageMask = nullptr,
                                .commandBufferCount = 1,
                                .pCommandBuffers = &commands,
                                .signalSemaphoreCount = 0,
                                .pSignalSemaphores = nullptr};
      {
        const std::scoped_lock hold(queueLock_);
        well = call<PFN_vkQueueSubmit>("vkQueueSubmit")(queue_, 1, &submit, fence) == VK_SUCCESS;
      }
      well =
          well && call<PFN_vkWaitForFences>("vkWaitForFences")(device_, 1, &fence, VK_TRUE, UINT64_MAX) == VK_SUCCESS;
      call<PFN_vkResetFences>("vkResetFences")(device_, 1, &fence);
    }
    std::uint64_t ticks = 0;
    well =
        well && call<PFN_vkGetQueryPoolResults>("vkGetQueryPoolResults")(
                    device_, queries, 0, 1, sizeof ticks, &ticks, sizeof ticks, VK_QUERY_RESULT_64_BIT) == VK_SUCCESS;
    call<PFN_vkDestroyQueryPool>("vkDestroyQueryPool")(device_, queries, nullptr);
    call<PFN_vkDestroyFence>("vkDestroyFence")(device_, fence, nullptr);
    call<PFN_vkDestroyCommandPool>("vkDestroyCommandPool")(device_, pool, nullptr);
    return well && ticks != 0;
  }

 private:
  template <class Function>
  Function call(const char* name) const {
    return reinterpret_cast<Function>(getProc_(instance_, name));
  }

  static VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
    ++static_cast<HostProgram*>(self)->messages_;
    MESSAGE(std::string(data->pMessage));
    return VK_FALSE;
  }

  void makeInstance() {
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pNext = nullptr,
                                        .pApplicationName = "a host",
                                        .applicationVersion = 1,
                                        .pEngineName = nullptr,
                                        .engineVersion = 0,
                                        .apiVersion = VK_API_VERSION_1_3};
    const char* const layer = "VK_LAYER_KHRONOS_validation";
    const char* const extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .pNext = nullptr,
                                    .flags = 0,
                                    .pApplicationInfo = &application,
                                    .enabledLayerCount = validates() ? 1u : 0u,
                                    .ppEnabledLayerNames = &layer,
                                    .enabledExtensionCount = validates() ? 1u : 0u,
                                    .ppEnabledExtensionNames = &extension};
    REQUIRE(call<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &instance_) == VK_SUCCESS);
    if (!validates()) return;
    const VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .pNext = nullptr,
        .flags = 0,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = &HostProgram::receive,
        .pUserData = this};
    REQUIRE(call<PFN_vkCreateDebugUtilsMessengerEXT>("vkCreateDebugUtilsMessengerEXT")(instance_, &messenger, nullptr,
                                                                                       &messenger_) == VK_SUCCESS);
  }

  // The first device whose name contains PALPATE_GPU, or the first.
  void choosePhysical() {
    std::array<VkPhysicalDevice, 8> devices{};
    std::uint32_t count = devices.size();
    call<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices")(instance_, &count, devices.data());
    REQUIRE(count > 0);
    physical_ = devices[0];
    const char* wanted = std::getenv("PALPATE_GPU");
    for (std::uint32_t i = 0; i < count && wanted; ++i) {
      VkPhysicalDeviceProperties properties;
      call<PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(devices[i], &properties);
      if (std::strstr(properties.deviceName, wanted)) physical_ = devices[i];
    }
  }

  void makeDevice(std::string_view without) {
    choosePhysical();
    std::array<VkQueueFamilyProperties, 16> families{};
    std::uint32_t count = families.size();
    call<PFN_vkGetPhysicalDeviceQueueFamilyProperties>("vkGetPhysicalDeviceQueueFamilyProperties")(physical_, &count,
                                                                                                   families.data());
    while (family_ < count && !(families[family_].queueFlags & VK_QUEUE_COMPUTE_BIT)) ++family_;
    REQUIRE(family_ < count);
    const auto on = [&](std::string_view feature) -> VkBool32 { return feature != without; };
    features12_.bufferDeviceAddress = on("bufferDeviceAddress");
    features12_.scalarBlockLayout = on("scalarBlockLayout");
    synchronization2_.synchronization2 = on("synchronization2");
    subgroups_.computeFullSubgroups = on("computeFullSubgroups");
    const float priority = 0.5f;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .pNext = nullptr,
                                        .flags = 0,
                                        .queueFamilyIndex = family_,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &features_,
                                  .flags = 0,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue,
                                  .enabledLayerCount = 0,
                                  .ppEnabledLayerNames = nullptr,
                                  .enabledExtensionCount = 0,
                                  .ppEnabledExtensionNames = nullptr,
                                  .pEnabledFeatures = nullptr};
    REQUIRE(call<PFN_vkCreateDevice>("vkCreateDevice")(physical_, &info, nullptr, &device_) == VK_SUCCESS);
    call<PFN_vkGetDeviceQueue>("vkGetDeviceQueue")(device_, family_, 0, &queue_);
  }

  void* loader_ = nullptr;  // never unloaded, as in a program that is linked to it
  PFN_vkGetInstanceProcAddr getProc_ = nullptr;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  // One struct of Vulkan 1.2 and two of the extensions that became part of 1.3.
  VkPhysicalDeviceSubgroupSizeControlFeatures subgroups_{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES};
  VkPhysicalDeviceSynchronization2Features synchronization2_{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES, .pNext = &subgroups_};
  VkPhysicalDeviceVulkan12Features features12_{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                               .pNext = &synchronization2_};
  VkPhysicalDeviceFeatures2 features_{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &features12_};
  VkDevice device_ = VK_NULL_HANDLE;
  std::uint32_t family_ = 0;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::mutex queueLock_;
  int holds_ = 0;  // under the lock
  std::atomic<int> messages_ = 0;
};

}  // namespace palpate
