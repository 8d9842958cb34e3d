#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/gpu/pipeline_store.hpp"

namespace palpate {

/// What becomes of the depth of a fragment.
enum class DepthUse {
  nearest,  ///< drawn where nothing nearer was, and kept
  within,   ///< drawn where nothing nearer was, and not kept
};

struct GraphicsOptions {
  VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  DepthUse depth = DepthUse::nearest;
  VkFormat depthFormat = VK_FORMAT_UNDEFINED;
  std::vector<VkFormat> colorFormats = {};    ///< of what is drawn to; what is drawn adds up there
  std::uint32_t pushBytes = 0;                ///< exact size of the arguments, for both shaders
  std::vector<std::uint32_t> constants = {};  ///< specialisation constants 0, 1, … of both
};

/// A vertex and a fragment shader without vertex buffers: what is drawn comes by address in the push constants, and the
/// vertex's number says what of it. Draws into attachments as they are (dynamic rendering).
class GraphicsPipeline {
 public:
  GraphicsPipeline(Device& device, const ShaderCode& vertex, const ShaderCode& fragment,
                   const GraphicsOptions& options);

  VkPipeline handle() const { return compiled_.pipeline; }
  VkPipelineLayout layout() const { return compiled_.layout; }
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
