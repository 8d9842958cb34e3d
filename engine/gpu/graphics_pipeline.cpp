#include "engine/gpu/graphics_pipeline.hpp"

#include <array>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

constexpr VkPipelineColorBlendAttachmentState kAddsUp{
    .blendEnable = VK_TRUE,
    .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
    .dstColorBlendFactor = VK_BLEND_FACTOR_ONE,
    .colorBlendOp = VK_BLEND_OP_ADD,
    .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
    .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
    .alphaBlendOp = VK_BLEND_OP_ADD,
    .colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT};

// All states but the shaders and the formats: those shared by all draws, and the depth state.
struct FixedStates {
  VkPipelineVertexInputStateCreateInfo input{.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  VkPipelineViewportStateCreateInfo viewport{.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  VkPipelineRasterizationStateCreateInfo raster{.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  VkPipelineMultisampleStateCreateInfo samples{.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  VkPipelineDepthStencilStateCreateInfo depth{.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  std::vector<VkPipelineColorBlendAttachmentState> blends;

  explicit FixedStates(const GraphicsOptions& options) : blends(options.colorFormats.size(), kAddsUp) {
    static constexpr std::array kDynamic{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    assembly.topology = options.topology;
    viewport.viewportCount = viewport.scissorCount = 1;
    raster.lineWidth = 1;
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    depth.depthTestEnable = VK_TRUE;
    depth.depthWriteEnable = options.depth == DepthUse::nearest;
    depth.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
    blend.attachmentCount = static_cast<std::uint32_t>(blends.size());
    blend.pAttachments = blends.data();
    dynamic.dynamicStateCount = kDynamic.size();
    dynamic.pDynamicStates = kDynamic.data();
  }
};

PipelineStore::Compiled compile(Device& device, const ShaderCode& vertex, const ShaderCode& fragment,
                                const GraphicsOptions& options) {
  PipelineStore::Compiled compiled{.readsBlock = readsBlock(vertex) || readsBlock(fragment)};
  makeLayout(device, GraphicsPipeline::kStages, options.pushBytes, 0, compiled);
  ShaderStage vertexStage(device, vertex, options.constants), fragmentStage(device, fragment, options.constants);
  const std::array stages{vertexStage.info(VK_SHADER_STAGE_VERTEX_BIT),
                          fragmentStage.info(VK_SHADER_STAGE_FRAGMENT_BIT)};
  const FixedStates states(options);
  const VkPipelineRenderingCreateInfo formats{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
      .pNext = nullptr,
      .viewMask = 0,
      .colorAttachmentCount = static_cast<std::uint32_t>(options.colorFormats.size()),
      .pColorAttachmentFormats = options.colorFormats.data(),
      .depthAttachmentFormat = options.depthFormat,
      .stencilAttachmentFormat = VK_FORMAT_UNDEFINED};
  const VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                          .pNext = &formats,
                                          .flags = 0,
                                          .stageCount = stages.size(),
                                          .pStages = stages.data(),
                                          .pVertexInputState = &states.input,
                                          .pInputAssemblyState = &states.assembly,
                                          .pTessellationState = nullptr,
                                          .pViewportState = &states.viewport,
                                          .pRasterizationState = &states.raster,
                                          .pMultisampleState = &states.samples,
                                          .pDepthStencilState = &states.depth,
                                          .pColorBlendState = &states.blend,
                                          .pDynamicState = &states.dynamic,
                                          .layout = compiled.layout,
                                          .renderPass = VK_NULL_HANDLE,
                                          .subpass = 0,
                                          .basePipelineHandle = VK_NULL_HANDLE,
                                          .basePipelineIndex = -1};
  device.check(
      device.vk().vkCreateGraphicsPipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &compiled.pipeline),
      fmt::format("vkCreateGraphicsPipelines({})", fragment.name));
  device.nameObject(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(compiled.pipeline), fragment.name);
  return compiled;
}

PipelineStore::Key keyOf(const ShaderCode& vertex, const ShaderCode& fragment, const GraphicsOptions& options) {
  PipelineStore::Key key{reinterpret_cast<std::uintptr_t>(vertex.words.data()),
                         reinterpret_cast<std::uintptr_t>(fragment.words.data()),
                         static_cast<std::uint64_t>(options.topology),
                         static_cast<std::uint64_t>(options.depth),
                         static_cast<std::uint64_t>(options.depthFormat),
                         options.pushBytes,
                         options.colorFormats.size()};
  for (const VkFormat format : options.colorFormats) key.push_back(static_cast<std::uint64_t>(format));
  key.insert(key.end(), options.constants.begin(), options.constants.end());
  return key;
}

}  // namespace

GraphicsPipeline::GraphicsPipeline(Device& device, const ShaderCode& vertex, const ShaderCode& fragment,
                                   const GraphicsOptions& options)
    : name_(fragment.name), pushBytes_(options.pushBytes), colors_(options.colorFormats.size()) {
  PALPATE_CHECK_LE(pushBytes_, kMaxPushBytes);
  PALPATE_CHECK(device.draws());
  compiled_ = device.pipelines().get(keyOf(vertex, fragment, options),
                                     [&] { return compile(device, vertex, fragment, options); });
}

}  // namespace palpate
