#version 460
#extension GL_GOOGLE_include_directive : require
// hardware_attributes.frag for a cloud without colours.
#include "shaders/render/hardware_fragment.glsl"

layout(location = 0) out vec4 normalAndWeight;

void main() { normalAndWeight = fragmentHere().weight * vec4(drawn.shading, 1); }
