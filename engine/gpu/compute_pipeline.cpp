#include "engine/gpu/compute_pipeline.hpp"

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/workgroup_watch.hpp"

namespace palpate {

namespace {

// Specialisation constants of watched shaders (shaders/lib/index.glsl): the halves of an address.
constexpr std::uint32_t kLifeLow = 30, kLifeHigh = 31;

// `life`: of WorkgroupWatch::Twin; 0: the shader is not watched.
PipelineStore::Compiled compile(Device& device, const ShaderCode& code, const PipelineOptions& options,
                                DeviceAddress life) {
  PipelineStore::Compiled compiled;
  const VkPushConstantRange range{.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .offset = 0, .size = options.pushBytes};
  const VkPipelineLayoutCreateInfo layoutInfo{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                              .pNext = nullptr,
                                              .flags = 0,
                                              .setLayoutCount = 0,
                                              .pSetLayouts = nullptr,
                                              .pushConstantRangeCount = options.pushBytes ? 1u : 0u,
                                              .pPushConstantRanges = &range};
  device.check(device.vk().vkCreatePipelineLayout(device.handle(), &layoutInfo, nullptr, &compiled.layout),
               "vkCreatePipelineLayout");

  std::vector<std::uint32_t> constants{options.workgroupSize};
  constants.insert(constants.end(), options.constants.begin(), options.constants.end());
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, i * 4, 4});
  if (life != 0) {
    for (const std::uint32_t id : {kLifeLow, kLifeHigh}) {
      entries.push_back({id, static_cast<std::uint32_t>(constants.size() * 4), 4});
      constants.push_back(static_cast<std::uint32_t>(id == kLifeLow ? life : life >> 32));
    }
  }
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
               fmt::format("vkCreateShaderModule({})", code.name));
  device.nameObject(VK_OBJECT_TYPE_SHADER_MODULE, reinterpret_cast<std::uint64_t>(module), code.name);
  // Full subgroups need a workgroup that the subgroup size divides; every size up to 128 divides or exceeds ours.
  const bool full = options.workgroupSize % device.subgroupSize() == 0;
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
      .layout = compiled.layout,
      .basePipelineHandle = VK_NULL_HANDLE,
      .basePipelineIndex = -1};
  const VkResult result =
      device.vk().vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &compiled.pipeline);
  device.vk().vkDestroyShaderModule(device.handle(), module, nullptr);
  device.check(result, fmt::format("vkCreateComputePipelines({})", code.name));
  device.nameObject(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(compiled.pipeline), code.name);
  return compiled;
}

}  // namespace

PipelineStore::Compiled PipelineStore::get(Device& device, const ShaderCode& code, const PipelineOptions& options) {
  const std::scoped_lock hold(lock_);
  const auto twin = watch_ ? watch_->twinOf(code) : std::nullopt;
  const ShaderCode& used = twin ? *twin->code : code;
  const DeviceAddress life = twin ? twin->life : 0;
  const Key key{used.words.data(), options.workgroupSize, options.pushBytes, options.constants, life};
  if (const auto found = compiled_.find(key); found != compiled_.end()) return found->second;
  return compiled_.emplace(key, compile(device, used, options, life)).first->second;
}

void PipelineStore::watch(const WorkgroupWatch* watch) {
  const std::scoped_lock hold(lock_);
  watch_ = watch;
}

void PipelineStore::destroyAll(Device& device) {
  for (const auto& [key, compiled] : compiled_) {
    device.vk().vkDestroyPipeline(device.handle(), compiled.pipeline, nullptr);
    device.vk().vkDestroyPipelineLayout(device.handle(), compiled.layout, nullptr);
  }
  compiled_.clear();
}

ComputePipeline::ComputePipeline(Device& device, const ShaderCode& code, const PipelineOptions& options)
    : name_(code.name), workgroupSize_(options.workgroupSize), pushBytes_(options.pushBytes) {
  PALPATE_CHECK_LE(pushBytes_, kMaxPushBytes);
  PALPATE_CHECK_EQ(workgroupSize_ % 32, 0u);  // lavapipe's subgroup operations are wrong otherwise
  PALPATE_CHECK_LE(workgroupSize_, device.properties().limits.maxComputeWorkGroupInvocations);
  compiled_ = device.pipelines().get(device, code, options);
}

}  // namespace palpate
