#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/core/vec.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class ComputePipeline;
class Device;

/// An image that draws write and compute passes read: a depth, or sums by blending. It is in the general layout
/// whenever it has contents, so that no code depends on its last use. Throws OutOfGpuMemory.
class Attachment {
 public:
  Attachment(Device& device, const UVec2& size_px, VkFormat format, std::string name);
  ~Attachment();
  Attachment(const Attachment&) = delete;
  Attachment& operator=(const Attachment&) = delete;

  VkImage handle() const { return image_; }
  VkImageView view() const { return view_; }
  VkImageAspectFlags aspect() const { return aspect_; }
  const UVec2& size_px() const { return size_px_; }
  const std::string& name() const { return name_; }

  /// Whether a device supports such an image in that format, can read it in a shader, and, unless it is a depth, can
  /// blend into it.
  static bool supports(const Device& device, VkFormat format);

 private:
  void release() noexcept;

  Device& device_;
  UVec2 size_px_;
  VkImageAspectFlags aspect_;
  std::string name_;
  std::uint64_t allocated_ = 0;
  VkImage image_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
};

/// The attachments that a compute pass reads, bound together: binding k of set 1 is the k-th. They must outlive this.
class ImageReads {
 public:
  ImageReads(Device& device, const ComputePipeline& pipeline, std::span<const Attachment* const> images);
  ~ImageReads();
  ImageReads(const ImageReads&) = delete;
  ImageReads& operator=(const ImageReads&) = delete;

  VkDescriptorSet handle() const { return set_; }

 private:
  Device& device_;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace palpate
