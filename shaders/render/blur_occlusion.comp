#version 460
#extension GL_GOOGLE_include_directive : require
// Removes the pattern of 4 x 4 pixels from the occlusion, within the surface: each of its 16 pixels has the same
// weight, times one of the distance from this pixel's plane.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/pattern.glsl"
#include "shaders/render/surfel.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { OcclusionArgs args; };

void main() {
  const RenderView view = frame.view;
  const ivec2 size = pictureSize(view);
  const uint place = threadIndex();
  if (place >= uint(size.x * size.y)) return;
  const ivec2 pixel = ivec2(place % uint(size.x), place / uint(size.x));
  const Surfel here = surfelAt(view, args.surfels, pixel);
  float sum = args.from.at[place], weights = 1;
  if (isSurface(here)) {
    const float band = kBlurRadii * frame.usualRadius + kBlurPixels * here.depth / pixelFocal(view);
    sum = weights = 0;
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        const ivec2 at = pixel + ivec2(x, y);
        const Surfel there = surfelAt(view, args.surfels, at);
        if (!isSurface(there)) continue;
        const float off = abs(dot(there.position - here.position, here.normal)) / band;
        const float alike = max(dot(there.normal, here.normal), 0);
        const float weight = shareOf(ivec2(x, y)) * max(1 - off, 0) * alike;
        sum += weight * args.from.at[at.y * size.x + at.x];
        weights += weight;
      }
  }
  args.to.at[place] = weights > 0 ? sum / weights : args.from.at[place];
}
