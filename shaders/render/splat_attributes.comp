#version 460
#extension GL_GOOGLE_include_directive : require
// Surface splatting in compute, pass 2: fragments close behind the nearest one add their normal and colour, weighted by
// a smooth falloff, so that neighbouring discs blend into one surface.
//
// Sums are integers, so their value does not depend on the order of the additions. The host chooses the fixed-point
// unit as 2^31 over the number of points at most: even if every point fell into one sample with full weight, no sum
// could overflow. In such a crowd the rounding errors average out; with few points in a sample the unit is fine where
// it counts.
#include "shaders/render/splat.glsl"

uint fixedPoint(float value, float scale) { return uint(int(round(value * scale))); }

void main() {
  const RenderView view = args.frame.at[0].view;
  Splat splat;
  if (!loadSplat(view, splat)) return;
  const float inverseRadiusSquared = 1 / (splat.disc.radius * splat.disc.radius);
  const float band = kDepthBand * splat.disc.radius;
  const float scale = args.frame.at[0].sumScale;
  // A few units, so that a sample which only such fragments cover keeps its colour; where many points make units coarse,
  // no more than a rim weighs.
  const float leastWeight = min(8 / scale, kRimWeight);
  const bool hasColors = args.frame.at[0].hasColors != 0;
  const vec3 color = hasColors ? unpackUnorm4x8(args.colors.at[splat.point]).rgb : vec3(0);
  for (int y = splat.box.first.y; y <= splat.box.last.y; ++y) {
    for (int x = splat.box.first.x; x <= splat.box.last.x; ++x) {
      Fragment fragment;
      if (!coverPixel(view, splat.disc, inverseRadiusSquared, ivec2(x, y), fragment)) continue;
      const uint place = uint(y) * view.size_px.x + uint(x);
      if (fragment.depth > uintBitsToFloat(args.depth.at[place]) + band) continue;
      const float weight = max(fragment.weight, leastWeight);
      for (uint k = 0; k < 3; ++k)
        atomicAdd(args.normalSums.at[4 * place + k], fixedPoint(weight * splat.disc.shading[k], scale));
      atomicAdd(args.normalSums.at[4 * place + 3], fixedPoint(weight, scale));
      if (!hasColors) continue;
      for (uint k = 0; k < 3; ++k)
        atomicAdd(args.colorSums.at[3 * place + k], fixedPoint(weight * color[k], scale));
    }
  }
}
