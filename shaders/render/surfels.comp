#version 460
#extension GL_GOOGLE_include_directive : require
// The surface element of every pixel of the picture.
#include "shaders/lib/index.glsl"
#include "shaders/render/depth_slope.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/sums.glsl"
#include "shaders/render/surfel.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { SurfelArgs args; };

void main() {
  const RenderView view = frame.view;
  const ivec2 size = pictureSize(view);
  const uint pixel = threadIndex();
  if (pixel >= uint(size.x * size.y)) return;
  const ivec2 at = sampleOfPixel(view, ivec2(pixel % uint(size.x), pixel / uint(size.x)));
  const uint source = args.source.at[uint(at.y) * view.size_px.x + uint(at.x)];
  const uint bits = args.depth.at[source];
  vec3 normal = vec3(0, 0, -1);
  if (bits != kNoDepth) {
    const ivec2 there = ivec2(source % view.size_px.x, source / view.size_px.x);
    normal = frame.smooth_px == 0 ? toEye(view, normalAt(args.normalSums, source))
                                             : normalFromDepth(view, args.depth, there);
    normal = dot(normal, normal) > 0 ? normalize(normal) : -normalize(rayThrough(view, vec2(at) + 0.5));
  }
  args.surfels.at[pixel] = uvec2(bits, packedUnit(normal));
}
