#include "engine/gpu/buffer.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/gpu/device.hpp"
#include "engine/gpu/gpu_memory.hpp"
#include "engine/gpu/unified_memory.hpp"

namespace palpate {

namespace {

constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                      VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;

constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

// Best first. Vulkan guarantees the last of each. `unified`: the host writes the GPU's own buffers in place.
std::span<const VkMemoryPropertyFlags> preferences(Memory memory, bool unified) {
  static constexpr std::array kDevice{kLocal, VkMemoryPropertyFlags{0}};
  static constexpr std::array kUnified{kLocal | kHost, kLocal, VkMemoryPropertyFlags{0}};
  static constexpr std::array kUpload{kLocal | kHost, kHost};
  static constexpr std::array kStaging{kHost};
  static constexpr std::array kReadback{kHost | kCached, kHost};
  switch (memory) {
    case Memory::device:
      return unified ? std::span<const VkMemoryPropertyFlags>(kUnified) : kDevice;
    case Memory::upload:
      return kUpload;
    case Memory::staging:
      return kStaging;
    case Memory::readback:
      return kReadback;
  }
  return kDevice;
}

OutOfGpuMemory tooLarge(const Device& device, const std::string& name, std::uint64_t bytes, std::uint64_t limit) {
  return OutOfGpuMemory("{}: '{}' needs {} MiB, more than the {} MiB that this GPU allows; ask for less", device.name(),
                        name, bytes >> 20, limit >> 20);
}

}  // namespace

std::optional<std::uint32_t> memoryType(const Device& device, std::uint32_t allowed, Memory memory) {
  const auto& properties = device.memory();
  for (const VkMemoryPropertyFlags wanted : preferences(memory, unifiedMemory(device).writes))
    for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i)
      if ((allowed >> i & 1) && (properties.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
  return std::nullopt;
}

VkDeviceMemory allocate(Device& device, const VkMemoryRequirements& needs, Memory memory, const std::string& name,
                        const void* next) {
  const auto type = memoryType(device, needs.memoryTypeBits, memory);
  if (!type) throw GpuError("{}: no memory type suits '{}'", device.name(), name);
  const auto& heap = device.memory().memoryHeaps[device.memory().memoryTypes[*type].heapIndex];
  if (needs.size > heap.size) throw tooLarge(device, name, needs.size, heap.size);
  const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .pNext = next,
                                  .allocationSize = needs.size,
                                  .memoryTypeIndex = *type};
  VkDeviceMemory allocated = VK_NULL_HANDLE;
  device.check(device.vk().vkAllocateMemory(device.handle(), &info, nullptr, &allocated),
               fmt::format("vkAllocateMemory of {} MiB for '{}'", needs.size >> 20, name));
  device.noteAllocation(needs.size);
  return allocated;
}

Buffer::Buffer(Device& device, std::uint64_t bytes, Memory memory, std::string name)
    : device_(&device), bytes_(bytes), name_(std::move(name)) {
  if (bytes > device.largestBuffer()) throw tooLarge(device, name_, bytes, device.largestBuffer());
  const auto families = device.roles().families();
  const bool oneFamily = families.size() == 1;
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .pNext = nullptr,
                                .flags = 0,
                                .size = std::max<std::uint64_t>(bytes, 16),
                                .usage = kUsage,
                                .sharingMode = oneFamily ? VK_SHARING_MODE_EXCLUSIVE : VK_SHARING_MODE_CONCURRENT,
                                .queueFamilyIndexCount = oneFamily ? 0u : static_cast<std::uint32_t>(families.size()),
                                .pQueueFamilyIndices = oneFamily ? nullptr : families.data()};
  try {
    device.check(device.vk().vkCreateBuffer(device.handle(), &info, nullptr, &buffer_), "vkCreateBuffer");
    VkMemoryRequirements needs;
    device.vk().vkGetBufferMemoryRequirements(device.handle(), buffer_, &needs);
    const VkMemoryAllocateFlagsInfo flags{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                          .pNext = nullptr,
                                          .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT,
                                          .deviceMask = 0};
    memory_ = allocate(device, needs, memory, name_, &flags);
    allocated_ = needs.size;
    device.check(device.vk().vkBindBufferMemory(device.handle(), buffer_, memory_, 0), "vkBindBufferMemory");
    if (memory != Memory::device || unifiedMemory(device).writes) {
      void* pointer = nullptr;
      device.check(device.vk().vkMapMemory(device.handle(), memory_, 0, VK_WHOLE_SIZE, 0, &pointer), "vkMapMemory");
      mapped_ = static_cast<std::byte*>(pointer);
    }
  } catch (...) {
    release();
    throw;
  }
  const VkBufferDeviceAddressInfo addressInfo{
      .sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, .pNext = nullptr, .buffer = buffer_};
  address_ = device.vk().vkGetBufferDeviceAddress(device.handle(), &addressInfo);
  device.nameObject(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(buffer_), name_);
}

Buffer::~Buffer() { release(); }

Buffer::Buffer(Buffer&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      bytes_(other.bytes_),
      allocated_(std::exchange(other.allocated_, 0)),
      name_(std::move(other.name_)),
      buffer_(std::exchange(other.buffer_, VK_NULL_HANDLE)),
      memory_(std::exchange(other.memory_, VK_NULL_HANDLE)),
      address_(other.address_),
      mapped_(std::exchange(other.mapped_, nullptr)) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  if (this == &other) return *this;
  release();
  device_ = std::exchange(other.device_, nullptr);
  bytes_ = other.bytes_;
  allocated_ = std::exchange(other.allocated_, 0);
  name_ = std::move(other.name_);
  buffer_ = std::exchange(other.buffer_, VK_NULL_HANDLE);
  memory_ = std::exchange(other.memory_, VK_NULL_HANDLE);
  address_ = other.address_;
  mapped_ = std::exchange(other.mapped_, nullptr);
  return *this;
}

void Buffer::release() noexcept {
  if (!device_) return;
  if (buffer_) device_->vk().vkDestroyBuffer(device_->handle(), buffer_, nullptr);
  if (memory_) device_->vk().vkFreeMemory(device_->handle(), memory_, nullptr);
  device_->noteRelease(std::exchange(allocated_, 0));
  buffer_ = VK_NULL_HANDLE;
  memory_ = VK_NULL_HANDLE;
}

}  // namespace palpate
