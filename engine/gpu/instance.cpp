#include "engine/gpu/instance.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "engine/gpu/host_device.hpp"
#include "engine/gpu/missing_software.hpp"

namespace palpate {

namespace {

// The layer's messages about itself: not about our use of Vulkan. They are about its set-up, or say that its own thread
// has not recorded the end of work within ten seconds, which happens on a busy machine.
bool isAboutTheLayer(std::string_view id, std::string_view text) {
  if (id == "UNASSIGNED-GPU-Assisted Validation Setup" || id == "UNASSIGNED-GPU-Assisted-Validation-Setup") return true;
  if (id.starts_with("UNASSIGNED-Vk") && id.ends_with("-state-timeout")) return true;
  constexpr std::array kRemarks{"Forcing ", "Enabling ", "shader instrumentation", "Both GPU Assisted Validation and"};
  if (id.find("GPU-Assisted") == std::string_view::npos && id.find("BestPractices") == std::string_view::npos) {
    constexpr std::array kIds{"UNASSIGNED-khronos-Validation-debug-build-warning-message",
                              "UNASSIGNED-khronos-validation-createinstance-status-message", "VALIDATION-SETTINGS",
                              "WARNING-Setting-Limit-Adjusted"};
    return std::ranges::find(kIds, id) != kIds.end();
  }
  for (const std::string_view remark : kRemarks)
    if (text.find(remark) != std::string_view::npos) return true;
  return false;
}

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr const char* kLoader = "Vulkan loader";

bool hasLayer(const char* name) {
  std::uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::ranges::any_of(layers, [&](const auto& layer) { return std::strcmp(layer.layerName, name) == 0; });
}

bool hasExtension(const char* layer, const char* name) {
  std::uint32_t count = 0;
  vkEnumerateInstanceExtensionProperties(layer, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateInstanceExtensionProperties(layer, &count, extensions.data());
  return std::ranges::any_of(extensions,
                             [&](const auto& extension) { return std::strcmp(extension.extensionName, name) == 0; });
}

}  // namespace

std::vector<std::string> ValidationMessages::take() {
  const std::scoped_lock hold(lock_);
  return std::exchange(messages_, {});
}

std::size_t ValidationMessages::count() const {
  const std::scoped_lock hold(lock_);
  return messages_.size();
}

VkDebugUtilsMessengerCreateInfoEXT ValidationMessages::messengerInfo() {
  return {.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
          .pNext = nullptr,
          .flags = 0,
          .messageSeverity =
              VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
          .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
          .pfnUserCallback = &ValidationMessages::receive,
          .pUserData = this};
}

VkBool32 ValidationMessages::receive(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
  const std::string_view id = data->pMessageIdName ? data->pMessageIdName : "";
  const std::string_view text = data->pMessage ? data->pMessage : "";
  if (isAboutTheLayer(id, text)) return VK_FALSE;
  auto& messages = *static_cast<ValidationMessages*>(self);
  const std::scoped_lock hold(messages.lock_);
  messages.messages_.push_back(fmt::format("{}: {}", id, text));
  fmt::print(stderr, "validation: {}\n", messages.messages_.back());
  return VK_FALSE;
}

Instance::Instance(Validation validation, std::span<const std::string> windowExtensions) : validation_(validation) {
  const bool validate = validates();
  if (volkInitialize() != VK_SUCCESS) throw GpuError("{}", kNoVulkanLoader);
  if (validate && !hasLayer(kValidationLayer))
    throw GpuError("validation: {} was not found; install {}", kValidationLayer, kValidationLayerSource);

  std::vector<const char*> layers, extensions;
  for (const std::string& name : windowExtensions) {
    if (!hasExtension(nullptr, name.c_str()))
      throw GpuError("the {} does not support {}, which windows require", kLoader, name);
    extensions.push_back(name.c_str());
  }
  if (validate) {
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
  }
  hasDebugUtils_ = hasExtension(nullptr, VK_EXT_DEBUG_UTILS_EXTENSION_NAME) ||
                   (validate && hasExtension(kValidationLayer, VK_EXT_DEBUG_UTILS_EXTENSION_NAME));
  if (hasDebugUtils_) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

  // Drivers that implement only a subset of Vulkan are listed only on request.
  const bool portable = hasExtension(nullptr, VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
  if (portable) extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);

  constexpr std::array kEnabled{VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT,
                                VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT,
                                VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_RESERVE_BINDING_SLOT_EXT};
  VkDebugUtilsMessengerCreateInfoEXT messenger = messages_.messengerInfo();
  const VkValidationFeaturesEXT features{
      .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
      .pNext = &messenger,
      .enabledValidationFeatureCount = validation == Validation::full ? std::uint32_t{kEnabled.size()} : 1,
      .pEnabledValidationFeatures = kEnabled.data(),
      .disabledValidationFeatureCount = 0,
      .pDisabledValidationFeatures = nullptr};
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .pNext = nullptr,
                                      .pApplicationName = "palpate",
                                      .applicationVersion = 1,
                                      .pEngineName = "palpate",
                                      .engineVersion = 1,
                                      .apiVersion = VK_API_VERSION_1_3};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pNext = validate ? &features : nullptr,
                                  .flags = portable
                                               ? VkInstanceCreateFlags{VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR}
                                               : VkInstanceCreateFlags{0},
                                  .pApplicationInfo = &application,
                                  .enabledLayerCount = static_cast<std::uint32_t>(layers.size()),
                                  .ppEnabledLayerNames = layers.data(),
                                  .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                                  .ppEnabledExtensionNames = extensions.data()};
  const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
    throw GpuError(
        "the Vulkan loader found no driver that it could load; install one (mesa-vulkan-drivers has a software "
        "driver), or see what VK_LOADER_DEBUG=all says");
  checkVk(result, "vkCreateInstance", kLoader);
  volkLoadInstanceOnly(instance_);
  if (validate)
    checkVk(vkCreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_),
            "vkCreateDebugUtilsMessengerEXT", kLoader);
}

Instance::Instance(const HostDevice& host)
    : owns_(false), validation_(host.validation), hasDebugUtils_(host.debugUtils), instance_(host.instance) {
  volkInitializeCustom(host.getInstanceProcAddr);
  volkLoadInstanceOnly(instance_);
}

Instance::~Instance() {
  if (!owns_) return;
  if (messenger_) vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
  if (instance_) vkDestroyInstance(instance_, nullptr);
}

std::vector<VkPhysicalDevice> Instance::physicalDevices() const {
  std::uint32_t count = 0;
  checkVk(vkEnumeratePhysicalDevices(instance_, &count, nullptr), "vkEnumeratePhysicalDevices", kLoader);
  std::vector<VkPhysicalDevice> devices(count);
  checkVk(vkEnumeratePhysicalDevices(instance_, &count, devices.data()), "vkEnumeratePhysicalDevices", kLoader);
  devices.resize(count);
  return devices;
}

}  // namespace palpate
