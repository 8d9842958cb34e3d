#version 460
#extension GL_GOOGLE_include_directive : require
// Discs by the graphics pipeline, pass 2 (Botsch and Kobbelt 2003): fragments are moved forward by the band in which
// discs blend, so that the depth test passes those close behind the nearest one. Blending sums their normals and
// colours, in the order of the points.
#include "shaders/render/hardware_fragment.glsl"

layout(location = 0) out vec4 normalAndWeight;
layout(location = 1) out vec4 color;

void main() {
  const float weight = fragmentHere().weight;
  normalAndWeight = weight * vec4(drawn.shading, 1);
  color = vec4(weight * unpackUnorm4x8(drawn.color).rgb, 0);
}
