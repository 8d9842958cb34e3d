#include "apps/view/presentation.hpp"

#include "apps/view/copied_presentation.hpp"
#include "engine/gpu/swapchain.hpp"

namespace palpate {

namespace {

bool isNvidias(VkPhysicalDevice gpu) {
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
  vkGetPhysicalDeviceProperties2(gpu, &properties);
  return driver.driverID == VK_DRIVER_ID_NVIDIA_PROPRIETARY;
}

}  // namespace

PresentationFound findPresentation(const Window& window, const Instance& instance, VkPhysicalDevice gpu) {
  const auto copied = [](std::string_view why) { return PresentationFound{Presentation::copy, std::string(why)}; };
  if (window.extensions().empty()) return copied("the window system cannot present from Vulkan");
  if (!canMakeSwapchains(gpu)) return copied("its driver does not support swapchains");
  if (isNvidias(gpu))
    if (const std::string_view why = whyNotAskNvidia(window); !why.empty()) return copied(why);
  const auto roles = chooseQueues(queueFamiliesOf(gpu));
  if (!roles) return copied("it has no compute queue");
  const VkSurfaceKHR surface = window.surface(instance);
  VkBool32 can = VK_FALSE;
  const VkResult result = vkGetPhysicalDeviceSurfaceSupportKHR(gpu, roles->throughput.family, surface, &can);
  vkDestroySurfaceKHR(instance.handle(), surface, nullptr);
  if (result != VK_SUCCESS || can != VK_TRUE) return copied("its driver cannot present to this display");
  return {};
}

std::unique_ptr<Presenter> makePresenter(const Window& window, Device& device, std::optional<Presentation> wanted,
                                         bool waitsForDisplay) {
  const PresentationFound found = wanted == Presentation::copy
                                      ? PresentationFound{Presentation::copy, "--present copy"}
                                      : findPresentation(window, device.instance(), device.physical());
  if (found.presentation == Presentation::swapchain)
    return std::make_unique<Swapchain>(device, window.surface(device.instance()), window.size_px(), waitsForDisplay);
  if (wanted == Presentation::swapchain)
    throw Error("--present swapchain: {} cannot present here: {}; use copy or auto", device.name(), found.why);
  if (!takesCopies(window))
    throw Error("{} cannot present to this window ({}), and pictures can be copied only to an X display", device.name(),
                found.why);
  return copyingPresenter(window, device, waitsForDisplay);
}

}  // namespace palpate
