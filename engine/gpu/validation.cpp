#include "engine/gpu/validation.hpp"

#include <algorithm>
#include <array>
#include <utility>

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

}  // namespace palpate
