#version 460
#extension GL_GOOGLE_include_directive : require
// Valleys are darker and ridges brighter, wherever the light is: by the mean curvature of the surface on screen, at two
// scales (after Mara et al. 2010, "GigaMesh and Gilgamesh", multi-scale integral invariants, and the cavity shading of
// sculpting programs). In each direction it is the mean of the curvature by normals, (n' - n)(p' - p) / |p' - p|^2, and
// of that by depth, 2 n (p' - p) / |p' - p|^2, which agree on a sphere. Positive: a valley.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/surfel.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { CavityArgs args; };

// Change of the normal over a ring, radians; pixels beyond a step in depth count as flat.
float bendOver(RenderView view, Surfel here, ivec2 pixel, int radius_px, float pixelSize, float slant, float byDepth) {
  const int diagonal_px = max(int(round(0.7071 * float(radius_px))), 1);
  float sum = 0;
  for (int k = 0; k < 9; ++k) {
    const ivec2 way = ivec2(k % 3 - 1, k / 3 - 1);
    if (k == 4) continue;
    const Surfel there = surfelAt(view, args.surfels, pixel + way * (way.x * way.y == 0 ? radius_px : diagonal_px));
    if (!isSurface(there)) continue;
    const vec3 away = there.position - here.position;
    const float squared = max(dot(away, away), 1e-30);
    const float weight = clamp(3 - sqrt(squared) * slant / (float(radius_px) * pixelSize), 0, 1);
    sum += weight * dot(byDepth * 2 * here.normal - (1 - byDepth) * (there.normal - here.normal), away) / squared;
  }
  return sum / 8 * float(radius_px) * pixelSize;
}

void main() {
  const RenderView view = frame.view;
  const ivec2 size = pictureSize(view);
  const uint place = threadIndex();
  if (place >= uint(size.x * size.y)) return;
  const ivec2 pixel = ivec2(place % uint(size.x), place / uint(size.x));
  const Surfel here = surfelAt(view, args.surfels, pixel);
  float factor = 1;
  if (isSurface(here)) {
    const float pixelSize = divisorAt(view, here.depth) / pixelFocal(view);
    const float slant = max(-dot(here.normal, normalize(sightTo(view, here.position))), 0.2);
    const int narrow_px =
        clamp(int(round(kCavityRadii * frame.usualRadius / pixelSize)), 1, int(kCavityWidest_px));
    const float bend = bendOver(view, here, pixel, narrow_px, pixelSize, slant, 0) +
                       bendOver(view, here, pixel, narrow_px * int(kCavityScale), pixelSize, slant, 0.5);
    const float effect = bend * inversesqrt(bend * bend + kCavityHalf * kCavityHalf);
    factor = 1 - (effect > 0 ? kValleyShade : kRidgeLight) * effect;
  }
  args.cavity.at[place] = factor;
}
