#version 460
#extension GL_GOOGLE_include_directive : require
// Lines in space, pass 2: blends the marks over the picture, in linear light.
#include "shaders/lib/index.glsl"
#include "shaders/render/color.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/view.glsl"

layout(push_constant, scalar) uniform Push { LineArgs args; };

void main() {
  const RenderView view = frame.view;
  const uvec2 size = view.size_px / view.supersample;
  const uint pixel = threadIndex();
  if (pixel >= size.x * size.y) return;
  const uint mark = args.marks.at[pixel];
  if (mark == 0) return;
  const vec4 behind = unpackUnorm4x8(args.image.at[pixel]);
  const vec4 line = unpackUnorm4x8(mark);
  const float opacity = 1 - (1 - behind.a) * (1 - line.a);
  const vec3 light = mix(toLinear(behind.rgb), toLinear(line.rgb), line.a / opacity);
  args.image.at[pixel] = packUnorm4x8(vec4(toEncoded(light), opacity));
}
