#include "engine/gpu/pipeline_store.hpp"

#include <array>

#include "engine/gpu/constant_block.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

// Specialisation constants that any shader may have: see shaders/lib/subgroup_meet.glsl, and, of watched ones,
// shaders/lib/index.glsl: the halves of an address.
constexpr std::uint32_t kLockstep = 29, kLifeLow = 30, kLifeHigh = 31;

VkShaderModule makeModule(Device& device, const ShaderCode& code) {
  const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                      .pNext = nullptr,
                                      .flags = 0,
                                      .codeSize = code.words.size_bytes(),
                                      .pCode = code.words.data()};
  VkShaderModule module = VK_NULL_HANDLE;
  device.check(device.vk().vkCreateShaderModule(device.handle(), &info, nullptr, &module),
               fmt::format("vkCreateShaderModule({})", code.name));
  device.nameObject(VK_OBJECT_TYPE_SHADER_MODULE, reinterpret_cast<std::uint64_t>(module), code.name);
  return module;
}

}  // namespace

PipelineStore::Compiled PipelineStore::get(const Key& key, const std::function<Compiled()>& compile) {
  std::unique_lock hold(lock_);
  while (!compiled_.try_emplace(key).second) {  // another thread has begun with it
    if (const auto& compiled = compiled_.at(key)) return *compiled;
    ended_.wait(hold);
  }
  hold.unlock();
  try {
    const Compiled compiled = compile();
    hold.lock();
    ended_.notify_all();
    return *(compiled_.at(key) = compiled);
  } catch (...) {
    if (!hold.owns_lock()) hold.lock();
    compiled_.erase(key);
    ended_.notify_all();
    throw;
  }
}

VkShaderModule PipelineStore::keptModule(Device& device, const ShaderCode& code) {
  const std::scoped_lock hold(lock_);
  if (!kept_.contains(&code))
    for (const ShaderCode* each : code.table) kept_.emplace(each, makeModule(device, *each));
  return kept_.at(&code);
}

void PipelineStore::destroyAll(Device& device) {
  for (const auto& [code, module] : kept_) device.vk().vkDestroyShaderModule(device.handle(), module, nullptr);
  kept_.clear();
  for (const auto& [key, compiled] : compiled_) {
    device.vk().vkDestroyPipeline(device.handle(), compiled->pipeline, nullptr);
    device.vk().vkDestroyPipelineLayout(device.handle(), compiled->layout, nullptr);
    for (const VkDescriptorSetLayout layout : {compiled->block, compiled->images})
      device.vk().vkDestroyDescriptorSetLayout(device.handle(), layout, nullptr);
  }
  compiled_.clear();
}

ShaderStage::ShaderStage(Device& device, const ShaderCode& code, std::vector<std::uint32_t> constants,
                         DeviceAddress life)
    : device_(device),
      constants_(std::move(constants)),
      isKept_(device.instance().validation() == Validation::full),
      module_(isKept_ ? device.pipelines().keptModule(device, code) : makeModule(device, code)) {
  for (std::uint32_t i = 0; i < constants_.size(); ++i) entries_.push_back({i, i * 4, 4});
  const auto add = [&](std::uint32_t id, std::uint64_t value) {
    entries_.push_back({id, static_cast<std::uint32_t>(constants_.size() * 4), 4});
    constants_.push_back(static_cast<std::uint32_t>(value));
  };
  if (device.driverId() == VK_DRIVER_ID_MESA_LLVMPIPE) add(kLockstep, 1);
  if (life != 0) add(kLifeLow, life), add(kLifeHigh, life >> 32);
  specialization_ = {.mapEntryCount = static_cast<std::uint32_t>(entries_.size()),
                     .pMapEntries = entries_.data(),
                     .dataSize = constants_.size() * 4,
                     .pData = constants_.data()};
}

ShaderStage::~ShaderStage() {
  if (!isKept_) device_.vk().vkDestroyShaderModule(device_.handle(), module_, nullptr);
}

VkPipelineShaderStageCreateInfo ShaderStage::info(VkShaderStageFlagBits stage, VkPipelineShaderStageCreateFlags flags,
                                                  std::uint32_t subgroupSize) {
  required_.requiredSubgroupSize = subgroupSize;
  return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
          .pNext = subgroupSize > 0 ? &required_ : nullptr,
          .flags = flags,
          .stage = stage,
          .module = module_,
          .pName = "main",
          .pSpecializationInfo = &specialization_};
}

bool readsBlock(const ShaderCode& code) {
  constexpr std::uint32_t kOpVariable = 59, kOpLoad = 61, kOpAccessChain = 65, kUniform = 2;
  constexpr std::size_t kHeader = 5;  // words
  std::uint32_t block = 0;
  for (std::size_t at = kHeader; at < code.words.size(); at += code.words[at] >> 16) {
    const std::uint32_t operation = code.words[at] & 0xffff;
    if (operation == kOpVariable && code.words[at + 3] == kUniform) block = code.words[at + 2];
    if ((operation == kOpLoad || operation == kOpAccessChain) && code.words[at + 3] == block) return true;
  }
  return false;
}

void makeLayout(Device& device, VkShaderStageFlags stages, std::uint32_t pushBytes, std::uint32_t images,
                PipelineStore::Compiled& compiled) {
  if (images > 0) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (std::uint32_t i = 0; i < images; ++i)
      bindings.push_back({.binding = i,
                          .descriptorType = VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
                          .descriptorCount = 1,
                          .stageFlags = stages,
                          .pImmutableSamplers = nullptr});
    const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                               .pNext = nullptr,
                                               .flags = 0,
                                               .bindingCount = images,
                                               .pBindings = bindings.data()};
    device.check(device.vk().vkCreateDescriptorSetLayout(device.handle(), &info, nullptr, &compiled.images),
                 "vkCreateDescriptorSetLayout");
  }
  if (compiled.readsBlock || images > 0) compiled.block = ConstantBlock::makeLayout(device);
  const std::array sets{compiled.block, compiled.images};
  const VkPushConstantRange range{.stageFlags = stages, .offset = 0, .size = pushBytes};
  const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                        .pNext = nullptr,
                                        .flags = 0,
                                        .setLayoutCount = images > 0            ? 2u
                                                          : compiled.readsBlock ? 1u
                                                                                : 0u,
                                        .pSetLayouts = sets.data(),
                                        .pushConstantRangeCount = pushBytes ? 1u : 0u,
                                        .pPushConstantRanges = &range};
  device.check(device.vk().vkCreatePipelineLayout(device.handle(), &info, nullptr, &compiled.layout),
               "vkCreatePipelineLayout");
}

}  // namespace palpate
