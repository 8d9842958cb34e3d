#include "engine/gpu/swapchain.hpp"

#include <algorithm>
#include <utility>

#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

// Without colour space conversion. All common window systems support one of these.
constexpr VkFormat kRedFirst = VK_FORMAT_R8G8B8A8_UNORM, kBlueFirst = VK_FORMAT_B8G8R8A8_UNORM;
constexpr std::uint64_t kLongestWait_ns = 100'000'000;  // for an image: the window's events must not wait

VkSurfaceFormatKHR formatOf(const Device& device, VkSurfaceKHR surface) {
  std::uint32_t count = 0;
  device.check(vkGetPhysicalDeviceSurfaceFormatsKHR(device.physical(), surface, &count, nullptr),
               "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  device.check(vkGetPhysicalDeviceSurfaceFormatsKHR(device.physical(), surface, &count, formats.data()),
               "vkGetPhysicalDeviceSurfaceFormatsKHR");
  for (const VkFormat wanted : {kRedFirst, kBlueFirst})
    for (const VkSurfaceFormatKHR& format : formats)
      if (format.format == wanted) return format;
  throw GpuError("{} supports no window format with 8 bits per colour", device.name());
}

VkPresentModeKHR modeOf(const Device& device, VkSurfaceKHR surface, bool waitsForDisplay) {
  if (waitsForDisplay) return VK_PRESENT_MODE_FIFO_KHR;
  std::uint32_t count = 0;
  device.check(vkGetPhysicalDeviceSurfacePresentModesKHR(device.physical(), surface, &count, nullptr),
               "vkGetPhysicalDeviceSurfacePresentModesKHR");
  std::vector<VkPresentModeKHR> modes(count);
  device.check(vkGetPhysicalDeviceSurfacePresentModesKHR(device.physical(), surface, &count, modes.data()),
               "vkGetPhysicalDeviceSurfacePresentModesKHR");
  for (const VkPresentModeKHR wanted : {VK_PRESENT_MODE_MAILBOX_KHR, VK_PRESENT_MODE_IMMEDIATE_KHR})
    if (std::ranges::count(modes, wanted)) return wanted;
  return VK_PRESENT_MODE_FIFO_KHR;
}

}  // namespace

Swapchain::Swapchain(Device& device, VkSurfaceKHR surface, const UVec2& size_px, bool waitsForDisplay)
    : Presenter(UVec2(0), waitsForDisplay), device_(device), surface_(surface), wanted_px_(size_px) {
  try {
    if (!device.window().canPresent(surface))
      throw GpuError("{} cannot show pictures in this window; choose another GPU", device.name());
    const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = nullptr, .flags = 0};
    device.check(device.vk().vkCreateSemaphore(device.handle(), &info, nullptr, &acquired_), "vkCreateSemaphore");
    make();
  } catch (...) {
    release();
    device_.vk().vkDestroySemaphore(device_.handle(), acquired_, nullptr);
    vkDestroySurfaceKHR(device_.instance().handle(), surface_, nullptr);
    throw;
  }
}

Swapchain::~Swapchain() {
  device_.vk().vkDeviceWaitIdle(device_.handle());  // the result is ignored: nothing runs on a lost device
  release();
  device_.vk().vkDestroySemaphore(device_.handle(), acquired_, nullptr);
  vkDestroySurfaceKHR(device_.instance().handle(), surface_, nullptr);
}

void Swapchain::release() {
  device_.vk().vkDestroySwapchainKHR(device_.handle(), std::exchange(swapchain_, VK_NULL_HANDLE), nullptr);
  for (const VkSemaphore semaphore : drawn_) device_.vk().vkDestroySemaphore(device_.handle(), semaphore, nullptr);
  drawn_.clear();
  images_.clear();
}

void Swapchain::make() {
  VkSurfaceCapabilitiesKHR can;
  device_.check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &can),
                "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  constexpr std::uint32_t kAsYouLike = 0xffffffffu;
  size_px_ = can.currentExtent.width == kAsYouLike
                 ? UVec2(std::clamp(wanted_px_.x, can.minImageExtent.width, can.maxImageExtent.width),
                         std::clamp(wanted_px_.y, can.minImageExtent.height, can.maxImageExtent.height))
                 : UVec2(can.currentExtent.width, can.currentExtent.height);
  stale_ = false;
  if (size_px_.x == 0 || size_px_.y == 0) return release();
  if (!(can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT))
    throw GpuError("{} cannot copy pictures to a window", device_.name());
  const VkSurfaceFormatKHR format = formatOf(device_, surface_);
  blueFirst_ = format.format == kBlueFirst;
  constexpr std::uint32_t kImages = 3;
  const VkSwapchainKHR old = swapchain_;
  const VkSwapchainCreateInfoKHR info{
      .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
      .pNext = nullptr,
      .flags = 0,
      .surface = surface_,
      .minImageCount = std::clamp(kImages, can.minImageCount, can.maxImageCount > 0 ? can.maxImageCount : kImages),
      .imageFormat = format.format,
      .imageColorSpace = format.colorSpace,
      .imageExtent = {size_px_.x, size_px_.y},
      .imageArrayLayers = 1,
      .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
      .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
      .queueFamilyIndexCount = 0,
      .pQueueFamilyIndices = nullptr,
      .preTransform = can.currentTransform,
      .compositeAlpha = can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
      .presentMode = modeOf(device_, surface_, waitsForDisplay_),
      .clipped = VK_TRUE,
      .oldSwapchain = old};
  VkSwapchainKHR made = VK_NULL_HANDLE;
  device_.check(device_.vk().vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &made), "vkCreateSwapchainKHR");
  release();
  swapchain_ = made;
  std::uint32_t count = 0;
  device_.check(device_.vk().vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, nullptr),
                "vkGetSwapchainImagesKHR");
  images_.resize(count);
  device_.check(device_.vk().vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, images_.data()),
                "vkGetSwapchainImagesKHR");
  const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = nullptr, .flags = 0};
  for (std::uint32_t i = 0; i < count; ++i) {
    VkSemaphore drawn = VK_NULL_HANDLE;
    device_.check(device_.vk().vkCreateSemaphore(device_.handle(), &semaphore, nullptr, &drawn), "vkCreateSemaphore");
    drawn_.push_back(drawn);
  }
}

void Swapchain::change(const UVec2& size_px, bool waitsForDisplay) {
  stale_ = stale_ || size_px != size_px_ || waitsForDisplay != waitsForDisplay_;
  wanted_px_ = size_px;
  waitsForDisplay_ = waitsForDisplay;
  if (!stale_) return;
  device_.waitIdle();
  make();
}

bool Swapchain::show(CommandList& list, const Buffer& picture, const std::function<void()>& record) {
  const auto image = acquire();
  if (!image) return false;
  list.begin();
  record();
  list.show(picture, images_[*image], size_px_);
  list.end();
  present(list, *image);
  return true;
}

std::optional<std::uint32_t> Swapchain::acquire() {
  waitForLast();  // one picture in flight: its inputs may be overwritten for the next one
  if (stale_) {
    device_.waitIdle();
    make();
    return std::nullopt;
  }
  if (!swapchain_) return std::nullopt;
  std::uint32_t image = 0;
  const VkResult result = device_.vk().vkAcquireNextImageKHR(device_.handle(), swapchain_, kLongestWait_ns, acquired_,
                                                             VK_NULL_HANDLE, &image);
  if (result == VK_TIMEOUT || result == VK_NOT_READY) return std::nullopt;
  stale_ = result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
  if (result == VK_ERROR_OUT_OF_DATE_KHR) return std::nullopt;
  if (result != VK_SUBOPTIMAL_KHR) device_.check(result, "vkAcquireNextImageKHR");
  return image;
}

void Swapchain::present(const CommandList& list, std::uint32_t image) {
  Queue& queue = device_.window();
  last_ = queue.submit(list, {.waits = acquired_, .signals = drawn_[image]});
  // A software driver waits for the picture during presentation, and would block all users of a shared queue.
  if (device_.roles().shared()) waitForLast();
  if (queue.present(swapchain_, image, drawn_[image]) != VK_SUCCESS) stale_ = true;
}

void Swapchain::waitForLast() {
  if (last_ != 0) device_.window().wait(std::exchange(last_, 0));
}

}  // namespace palpate
