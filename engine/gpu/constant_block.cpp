#include "engine/gpu/constant_block.hpp"

#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

constexpr VkDescriptorType kType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC;

std::uint64_t strideOf(const Device& device, std::uint64_t bytes) {
  const std::uint64_t step = device.properties().limits.minUniformBufferOffsetAlignment;
  return (bytes + step - 1) / step * step;
}

}  // namespace

VkDescriptorSetLayout ConstantBlock::makeLayout(Device& device) {
  const VkDescriptorSetLayoutBinding binding{
      .binding = 0,
      .descriptorType = kType,
      .descriptorCount = 1,
      .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
      .pImmutableSamplers = nullptr};
  const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                             .pNext = nullptr,
                                             .flags = 0,
                                             .bindingCount = 1,
                                             .pBindings = &binding};
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  device.check(device.vk().vkCreateDescriptorSetLayout(device.handle(), &info, nullptr, &layout),
               "vkCreateDescriptorSetLayout");
  return layout;
}

ConstantBlock::ConstantBlock(Device& device, std::uint64_t bytes, std::uint32_t slots, const std::string& name)
    : device_(device),
      stride_(strideOf(device, bytes)),
      buffer_(device, slots * stride_, Memory::upload, name),
      layout_(makeLayout(device)) {
  const VkDescriptorPoolSize size{.type = kType, .descriptorCount = 1};
  const VkDescriptorPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                            .pNext = nullptr,
                                            .flags = 0,
                                            .maxSets = 1,
                                            .poolSizeCount = 1,
                                            .pPoolSizes = &size};
  device.check(device.vk().vkCreateDescriptorPool(device.handle(), &poolInfo, nullptr, &pool_),
               "vkCreateDescriptorPool");
  const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                         .pNext = nullptr,
                                         .descriptorPool = pool_,
                                         .descriptorSetCount = 1,
                                         .pSetLayouts = &layout_};
  device.check(device.vk().vkAllocateDescriptorSets(device.handle(), &info, &set_), "vkAllocateDescriptorSets");
  const VkDescriptorBufferInfo range{.buffer = buffer_.handle(), .offset = 0, .range = bytes};
  const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                   .pNext = nullptr,
                                   .dstSet = set_,
                                   .dstBinding = 0,
                                   .dstArrayElement = 0,
                                   .descriptorCount = 1,
                                   .descriptorType = kType,
                                   .pImageInfo = nullptr,
                                   .pBufferInfo = &range,
                                   .pTexelBufferView = nullptr};
  device.vk().vkUpdateDescriptorSets(device.handle(), 1, &write, 0, nullptr);
}

ConstantBlock::~ConstantBlock() {
  device_.vk().vkDestroyDescriptorPool(device_.handle(), pool_, nullptr);
  device_.vk().vkDestroyDescriptorSetLayout(device_.handle(), layout_, nullptr);
}

}  // namespace palpate
