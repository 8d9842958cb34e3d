#include "engine/gpu/compute_pipeline.hpp"

#include <array>

#include "engine/core/check.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/constant_block.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/workgroup_watch.hpp"

namespace palpate {

namespace {

// A software driver defers compiling a shader to its first run, for seconds, which no tick should wait for. A dispatch
// of zero workgroups triggers it as well. Skipped under validation, where time does not matter and tests do not run
// every pipeline.
void translateNow(Device& device, const ShaderCode& code, const PipelineOptions& options,
                  const PipelineStore::Compiled& compiled) {
  if (!device.isCpu() || device.instance().validates() || options.images > 0) return;
  CommandList list(device, device.backgroundQueue(), code.name);
  list.begin();
  const ConstantBlock block(device, kMaxPushBytes, 1, "no constants");
  const std::uint32_t offset = block.offset(0);
  const VkDescriptorSet set = block.handle();
  if (compiled.readsBlock)
    device.vk().vkCmdBindDescriptorSets(list.handle(), VK_PIPELINE_BIND_POINT_COMPUTE, compiled.layout, 0, 1, &set, 1,
                                        &offset);
  device.vk().vkCmdBindPipeline(list.handle(), VK_PIPELINE_BIND_POINT_COMPUTE, compiled.pipeline);
  // No invocation reads the arguments, but Vulkan requires them.
  static constexpr std::array<std::byte, kMaxPushBytes> kNothing{};
  if (options.pushBytes > 0)
    device.vk().vkCmdPushConstants(list.handle(), compiled.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, options.pushBytes,
                                   kNothing.data());
  device.vk().vkCmdDispatch(list.handle(), 0, 1, 1);
  list.end();
  device.backgroundQueue().run(list);
}

// `life`: of WorkgroupWatch::Twin; 0: the shader is not watched.
PipelineStore::Compiled compile(Device& device, const ShaderCode& code, const PipelineOptions& options,
                                DeviceAddress life) {
  PipelineStore::Compiled compiled{.readsBlock = readsBlock(code)};
  makeLayout(device, VK_SHADER_STAGE_COMPUTE_BIT, options.pushBytes, options.images, compiled);
  std::vector<std::uint32_t> constants{options.workgroupSize};
  constants.insert(constants.end(), options.constants.begin(), options.constants.end());
  ShaderStage shader(device, code, std::move(constants), life);
  // Full subgroups need a workgroup size that is a multiple of the subgroup size; a smaller workgroup uses no
  // subgroups.
  const bool full = options.workgroupSize % device.subgroupSize() == 0;
  const VkComputePipelineCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
      .pNext = nullptr,
      .flags = VK_PIPELINE_CREATE_DISPATCH_BASE_BIT,  // CommandList splits dispatches into slices
      .stage = shader.info(VK_SHADER_STAGE_COMPUTE_BIT,
                           full ? VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT : 0,
                           full && device.requiresSubgroupSize() ? device.subgroupSize() : 0),
      .layout = compiled.layout,
      .basePipelineHandle = VK_NULL_HANDLE,
      .basePipelineIndex = -1};
  device.check(
      device.vk().vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &compiled.pipeline),
      fmt::format("vkCreateComputePipelines({})", code.name));
  device.nameObject(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(compiled.pipeline), code.name);
  translateNow(device, code, options, compiled);
  return compiled;
}

PipelineStore::Key keyOf(const ShaderCode& code, const PipelineOptions& options, DeviceAddress life) {
  PipelineStore::Key key{reinterpret_cast<std::uintptr_t>(code.words.data()), options.workgroupSize, options.pushBytes,
                         options.images, life};
  key.insert(key.end(), options.constants.begin(), options.constants.end());
  return key;
}

}  // namespace

std::uint32_t sharedBytes(const Device& device) { return device.properties().limits.maxComputeSharedMemorySize; }

ComputePipeline::ComputePipeline(Device& device, const ShaderCode& code, const PipelineOptions& options)
    : name_(code.name),
      workgroupSize_(options.workgroupSize),
      sliceThreads_(options.sliceThreads),
      pushBytes_(options.pushBytes) {
  PALPATE_CHECK_LE(pushBytes_, kMaxPushBytes);
  PALPATE_CHECK_EQ(workgroupSize_ % 32, 0u);  // lavapipe's subgroup operations are wrong otherwise
  const std::uint32_t most = device.widestWorkgroup();
  if (workgroupSize_ > most)
    throw GpuError("{}: {} needs workgroups of {} invocations; the device supports {} at most", device.name(), name_,
                   workgroupSize_, most);
  const WorkgroupWatch* watch = device.pipelines().watch();
  const auto twin = watch ? watch->twinOf(code) : std::nullopt;
  const ShaderCode& used = twin ? *twin->code : code;
  const DeviceAddress life = twin ? twin->life : 0;
  throwIfStopWanted();
  compiled_ = device.pipelines().get(keyOf(used, options, life), [&] { return compile(device, used, options, life); });
}

}  // namespace palpate
