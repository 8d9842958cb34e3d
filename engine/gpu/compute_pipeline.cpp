#include "engine/gpu/compute_pipeline.hpp"

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

ComputePipeline::ComputePipeline(Device& device, const ShaderCode& code, const PipelineOptions& options)
    : device_(device), name_(code.name), workgroupSize_(options.workgroupSize), pushBytes_(options.pushBytes) {
  PALPATE_CHECK_LE(pushBytes_, kMaxPushBytes);
  PALPATE_CHECK_EQ(workgroupSize_ % 32, 0u);  // lavapipe's subgroup operations are wrong otherwise
  PALPATE_CHECK_LE(workgroupSize_, device.properties().limits.maxComputeWorkGroupInvocations);

  const VkPushConstantRange range{.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .offset = 0, .size = pushBytes_};
  const VkPipelineLayoutCreateInfo layoutInfo{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                              .pNext = nullptr,
                                              .flags = 0,
                                              .setLayoutCount = 0,
                                              .pSetLayouts = nullptr,
                                              .pushConstantRangeCount = pushBytes_ ? 1u : 0u,
                                              .pPushConstantRanges = &range};
  device.check(device.vk().vkCreatePipelineLayout(device.handle(), &layoutInfo, nullptr, &layout_),
               "vkCreatePipelineLayout");

  std::vector<std::uint32_t> constants{workgroupSize_};
  constants.insert(constants.end(), options.constants.begin(), options.constants.end());
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, i * 4, 4});
  const VkSpecializationInfo specialization{.mapEntryCount = static_cast<std::uint32_t>(entries.size()),
                                            .pMapEntries = entries.data(),
                                            .dataSize = constants.size() * 4,
                                            .pData = constants.data()};
  const VkShaderModuleCreateInfo moduleInfo{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                            .pNext = nullptr,
                                            .flags = 0,
                                            .codeSize = code.words.size_bytes(),
                                            .pCode = code.words.data()};
  VkShaderModule module = VK_NULL_HANDLE;
  device.check(device.vk().vkCreateShaderModule(device.handle(), &moduleInfo, nullptr, &module),
               fmt::format("vkCreateShaderModule({})", name_));
  device.nameObject(VK_OBJECT_TYPE_SHADER_MODULE, reinterpret_cast<std::uint64_t>(module), name_);
  // Full subgroups need a workgroup that the subgroup size divides; every size up to 128 divides or exceeds ours.
  const bool full = workgroupSize_ % device.subgroupSize() == 0;
  const VkComputePipelineCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
      .pNext = nullptr,
      .flags = 0,
      .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .pNext = nullptr,
                .flags =
                    full ? VkPipelineShaderStageCreateFlags{VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT}
                         : 0,
                .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                .module = module,
                .pName = "main",
                .pSpecializationInfo = &specialization},
      .layout = layout_,
      .basePipelineHandle = VK_NULL_HANDLE,
      .basePipelineIndex = -1};
  const VkResult result =
      device.vk().vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_);
  device.vk().vkDestroyShaderModule(device.handle(), module, nullptr);
  device.check(result, fmt::format("vkCreateComputePipelines({})", name_));
  device.nameObject(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline_), name_);
}

ComputePipeline::~ComputePipeline() {
  device_.vk().vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
  device_.vk().vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
}

}  // namespace palpate
