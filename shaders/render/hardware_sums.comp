#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// Converts the attachments of the graphics pipeline into the depths and sums that the later passes read, in the form in
// which splat_depth.comp and splat_attributes.comp write them.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/sums.glsl"
#include "shaders/shared/hardware_raster.h"

layout(push_constant, scalar) uniform Push { HardwareSumsArgs args; };

layout(set = 1, binding = 0) uniform texture2D depths;
layout(set = 1, binding = 1) uniform texture2D normals;
layout(set = 1, binding = 2) uniform texture2D colors;  // any texture, for a cloud without colours

void main() {
  const uint place = threadIndex();
  const uvec2 size = frame.view.size_px;
  if (place >= size.x * size.y) return;
  const ivec2 at = ivec2(place % size.x, place / size.x);
  const float depth = texelFetch(depths, at, 0).r;
  args.depth.at[place] = depth < 1 ? floatBitsToUint(depth * args.depthUnit) : kNoDepth;
  // Only ratios of weights count, so the total may be the same everywhere.
  const vec4 normal = texelFetch(normals, at, 0);
  const float scale = normal.w > 0 ? kHardwareWeight / normal.w : 0;
  storeNormal(args.normalSums, place, normal, scale);
  if (frame.hasColors == 0) return;
  storeColor(args.colorSums, place, size.x * size.y, texelFetch(colors, at, 0).rgb, scale);
}
