#version 460
#extension GL_GOOGLE_include_directive : require
// Eye-dome light (Boucheny 2009, "Interactive scientific visualization of large datasets", chapter 3): a sample darkens
// by how much nearer the samples around it are. Requires no normals, so it shapes bare points and unlit colours.
#include "shaders/lib/index.glsl"
#include "shaders/render/view.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { EyeDomeArgs args; };

void main() {
  const RenderView view = args.frame.at[0].view;
  const uint place = threadIndex();
  if (place >= view.size_px.x * view.size_px.y) return;
  const uint bits = args.depth.at[args.source.at[place]];
  if (bits == kNoDepth) return;
  const ivec2 at = ivec2(place % view.size_px.x, place / view.size_px.x);
  const float here = log2(uintBitsToFloat(bits));
  float sum = 0;
  for (uint ring = 1; ring <= kEyeDomeRings; ++ring) {
    const float wanted_px = kEyeDomeWidest_px * float(view.supersample) * float(ring) / float(kEyeDomeRings);
    const int radius_px = max(int(round(wanted_px)), 1);
    for (int k = 0; k < 9; ++k) {
      const ivec2 there = at + radius_px * ivec2(k % 3 - 1, k / 3 - 1);
      if (k == 4 || any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, ivec2(view.size_px)))) continue;
      const uint nearBits = args.depth.at[args.source.at[uint(there.y) * view.size_px.x + uint(there.x)]];
      if (nearBits == kNoDepth) continue;
      const float slope = (here - log2(uintBitsToFloat(nearBits))) * view.focal_px / float(radius_px);
      sum += clamp(slope, 0, kEyeDomeSteepest);
    }
  }
  const float factor = exp(-kEyeDomeStrength * sum / float(8 * kEyeDomeRings));
  const uvec2 packed = args.shaded.at[place];
  const vec3 light = factor * vec3(unpackHalf2x16(packed.x), unpackHalf2x16(packed.y).x);
  args.shaded.at[place] = uvec2(packHalf2x16(light.rg), packHalf2x16(vec2(light.b, 1)));
}
