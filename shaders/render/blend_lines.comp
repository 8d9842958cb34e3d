#version 460
#extension GL_GOOGLE_include_directive : require
// Lines in space, pass 2: blends the marks over the picture, in linear light.
#include "shaders/lib/index.glsl"
#include "shaders/render/color.glsl"
#include "shaders/render/view.glsl"

layout(push_constant, scalar) uniform Push { LineArgs args; };

void main() {
  const RenderView view = args.frame.at[0].view;
  const uvec2 size = view.size_px / view.supersample;
  const uint pixel = threadIndex();
  if (pixel >= size.x * size.y) return;
  const uint mark = args.marks.at[pixel];
  if (mark == 0) return;
  const vec3 behind = toLinear(unpackUnorm4x8(args.image.at[pixel]).rgb);
  const vec4 line = unpackUnorm4x8(mark);
  args.image.at[pixel] = packUnorm4x8(vec4(toEncoded(mix(behind, toLinear(line.rgb), line.a)), 1));
}
