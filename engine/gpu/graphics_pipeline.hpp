#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/gpu/pipeline_store.hpp"

namespace palpate {

/// The depth test and write of a fragment.
enum class DepthUse {
  nearest,  ///< drawn if no nearer fragment was, and its depth is written
  within,   ///< drawn if no nearer fragment was, without writing its depth
};

struct GraphicsOptions {
  VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  DepthUse depth = DepthUse::nearest;
  VkFormat depthFormat = VK_FORMAT_UNDEFINED;
  std::vector<VkFormat> colorFormats = {};    ///< of the targets, which are blended additively
  std::uint32_t pushBytes = 0;                ///< exact size of the arguments, for both shaders
  std::vector<std::uint32_t> constants = {};  ///< specialisation constants 0, 1, … of both
};

/// A vertex and a fragment shader without vertex buffers: vertices are read by address from the push constants, by the
/// vertex index. Uses dynamic rendering.
class GraphicsPipeline {
 public:
  GraphicsPipeline(Device& device, const ShaderCode& vertex, const ShaderCode& fragment,
                   const GraphicsOptions& options);

  VkPipeline handle() const { return compiled_.pipeline; }
  VkPipelineLayout layout() const { return compiled_.layout; }
  bool readsBlock() const { return compiled_.readsBlock; }
  static constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  std::uint32_t pushBytes() const { return pushBytes_; }
  std::size_t colors() const { return colors_; }
  const std::string& name() const { return name_; }  ///< of the fragment shader

 private:
  std::string name_;
  std::uint32_t pushBytes_;
  std::size_t colors_;
  PipelineStore::Compiled compiled_;
};

}  // namespace palpate
