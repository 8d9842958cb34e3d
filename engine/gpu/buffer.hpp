#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/core/check.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;

/// The use of a buffer, which determines its memory type.
enum class Memory {
  device,    ///< accessed by the GPU only
  upload,    ///< the host writes, the GPU reads; in the GPU's own memory if the host can access it
  staging,   ///< the host writes in order, the GPU copies from it; in the host's memory
  readback,  ///< the GPU writes, the host reads; cached on the host
};

/// The best memory type for that use among those `allowed` (a bit each); empty if none is suitable.
std::optional<std::uint32_t> memoryType(const Device& device, std::uint32_t allowed, Memory memory);

/// A range of GPU memory that shaders access by its address. Mapped while it lives if the host may access it. Zero
/// bytes are allowed and give a valid address. Throws OutOfGpuMemory.
class Buffer {
 public:
  Buffer(Device& device, std::uint64_t bytes, Memory memory, std::string name);
  template <class T>
  static Buffer of(Device& device, std::uint64_t count, Memory memory, std::string name) {
    return Buffer(device, count * sizeof(T), memory, std::move(name));
  }
  ~Buffer();
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;

  VkBuffer handle() const { return buffer_; }
  DeviceAddress address() const { return address_; }
  /// The requested size.
  std::uint64_t bytes() const { return bytes_; }
  const std::string& name() const { return name_; }

  /// The host's view; not of a device buffer, except with unifiedMemory().
  template <class T>
  std::span<T> mapped() const {
    PALPATE_CHECK(mapped_ != nullptr);
    return {reinterpret_cast<T*>(mapped_), static_cast<std::size_t>(bytes_ / sizeof(T))};
  }

 private:
  void release() noexcept;

  Device* device_ = nullptr;
  std::uint64_t bytes_ = 0;
  std::uint64_t allocated_ = 0;  // as rounded up by the driver
  std::string name_;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  DeviceAddress address_ = 0;
  std::byte* mapped_ = nullptr;
};

/// Words of 32 bits that only the GPU accesses.
inline Buffer deviceWords(Device& device, std::uint64_t count, const char* name) {
  return Buffer::of<std::uint32_t>(device, count, Memory::device, name);
}

}  // namespace palpate
