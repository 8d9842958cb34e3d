#pragma once

#include <cstdint>
#include <string>

#include "engine/gpu/buffer.hpp"

namespace palpate {

class Device;

/// Constants that all invocations of a pass read alike, as a uniform block: set 0, binding 0, in scalar layout. A GPU
/// keeps them in its constant cache, and a software driver reads them once and not for each invocation, as it does what
/// is read by address. The host writes one slot while passes in flight read others (CommandList::use).
class ConstantBlock {
 public:
  /// `bytes`: of a slot. Throws OutOfGpuMemory.
  ConstantBlock(Device& device, std::uint64_t bytes, std::uint32_t slots, const std::string& name);
  ~ConstantBlock();
  ConstantBlock(const ConstantBlock&) = delete;
  ConstantBlock& operator=(const ConstantBlock&) = delete;

  template <class T>
  void write(std::uint32_t slot, const T& constants) {
    PALPATE_CHECK_LE(sizeof(T), stride_);
    *reinterpret_cast<T*>(buffer_.mapped<std::byte>().subspan(offset(slot), sizeof(T)).data()) = constants;
  }
  VkDescriptorSet handle() const { return set_; }
  std::uint32_t offset(std::uint32_t slot) const { return slot * static_cast<std::uint32_t>(stride_); }

  /// Of set 0 in the layout of each pipeline that reads a block. The caller destroys it.
  static VkDescriptorSetLayout makeLayout(Device& device);

 private:
  Device& device_;
  std::uint64_t stride_;
  Buffer buffer_;
  VkDescriptorSetLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace palpate
