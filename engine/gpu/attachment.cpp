#include "engine/gpu/attachment.hpp"

#include <utility>
#include <vector>

#include "engine/gpu/compute_pipeline.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/gpu_memory.hpp"

namespace palpate {

namespace {

bool isDepth(VkFormat format) { return format == VK_FORMAT_D32_SFLOAT; }

}  // namespace

bool Attachment::supports(const Device& device, VkFormat format) {
  VkFormatProperties properties;
  vkGetPhysicalDeviceFormatProperties(device.physical(), format, &properties);
  const VkFormatFeatureFlags wanted =
      VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT |
      (isDepth(format) ? VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT);
  return (properties.optimalTilingFeatures & wanted) == wanted;
}

Attachment::Attachment(Device& device, const UVec2& size_px, VkFormat format, std::string name)
    : device_(device),
      size_px_(size_px),
      aspect_(isDepth(format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT),
      name_(std::move(name)) {
  const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                               .pNext = nullptr,
                               .flags = 0,
                               .imageType = VK_IMAGE_TYPE_2D,
                               .format = format,
                               .extent = {size_px.x, size_px.y, 1},
                               .mipLevels = 1,
                               .arrayLayers = 1,
                               .samples = VK_SAMPLE_COUNT_1_BIT,
                               .tiling = VK_IMAGE_TILING_OPTIMAL,
                               .usage = VK_IMAGE_USAGE_SAMPLED_BIT |
                                        VkImageUsageFlags(isDepth(format) ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                                          : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT),
                               .sharingMode = VK_SHARING_MODE_EXCLUSIVE,  // used by one queue only
                               .queueFamilyIndexCount = 0,
                               .pQueueFamilyIndices = nullptr,
                               .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
  try {
    device.check(device.vk().vkCreateImage(device.handle(), &info, nullptr, &image_), "vkCreateImage");
    VkMemoryRequirements needs;
    device.vk().vkGetImageMemoryRequirements(device.handle(), image_, &needs);
    memory_ = allocate(device, needs, Memory::device, name_);
    allocated_ = needs.size;
    device.check(device.vk().vkBindImageMemory(device.handle(), image_, memory_, 0), "vkBindImageMemory");
    const VkImageViewCreateInfo viewInfo{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .pNext = nullptr,
        .flags = 0,
        .image = image_,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = format,
        .components = {},
        .subresourceRange = {
            .aspectMask = aspect_, .baseMipLevel = 0, .levelCount = 1, .baseArrayLayer = 0, .layerCount = 1}};
    device.check(device.vk().vkCreateImageView(device.handle(), &viewInfo, nullptr, &view_), "vkCreateImageView");
  } catch (...) {
    release();
    throw;
  }
  device.nameObject(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(image_), name_);
}

Attachment::~Attachment() { release(); }

void Attachment::release() noexcept {
  device_.vk().vkDestroyImageView(device_.handle(), view_, nullptr);
  device_.vk().vkDestroyImage(device_.handle(), image_, nullptr);
  device_.vk().vkFreeMemory(device_.handle(), memory_, nullptr);
  device_.noteRelease(std::exchange(allocated_, 0));
}

ImageReads::ImageReads(Device& device, const ComputePipeline& pipeline, std::span<const Attachment* const> images)
    : device_(device) {
  const auto count = static_cast<std::uint32_t>(images.size());
  const VkDescriptorPoolSize size{.type = VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, .descriptorCount = count};
  const VkDescriptorPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                            .pNext = nullptr,
                                            .flags = 0,
                                            .maxSets = 1,
                                            .poolSizeCount = 1,
                                            .pPoolSizes = &size};
  device.check(device.vk().vkCreateDescriptorPool(device.handle(), &poolInfo, nullptr, &pool_),
               "vkCreateDescriptorPool");
  const VkDescriptorSetLayout layout = pipeline.imageLayout();
  const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                         .pNext = nullptr,
                                         .descriptorPool = pool_,
                                         .descriptorSetCount = 1,
                                         .pSetLayouts = &layout};
  device.check(device.vk().vkAllocateDescriptorSets(device.handle(), &info, &set_), "vkAllocateDescriptorSets");
  std::vector<VkDescriptorImageInfo> views;
  for (const Attachment* image : images) views.push_back({VK_NULL_HANDLE, image->view(), VK_IMAGE_LAYOUT_GENERAL});
  std::vector<VkWriteDescriptorSet> writes;
  for (std::uint32_t k = 0; k < count; ++k)
    writes.push_back({.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                      .pNext = nullptr,
                      .dstSet = set_,
                      .dstBinding = k,
                      .dstArrayElement = 0,
                      .descriptorCount = 1,
                      .descriptorType = VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
                      .pImageInfo = &views[k],
                      .pBufferInfo = nullptr,
                      .pTexelBufferView = nullptr});
  device.vk().vkUpdateDescriptorSets(device.handle(), count, writes.data(), 0, nullptr);
}

ImageReads::~ImageReads() { device_.vk().vkDestroyDescriptorPool(device_.handle(), pool_, nullptr); }

}  // namespace palpate
