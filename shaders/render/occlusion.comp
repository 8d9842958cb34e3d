#version 460
#extension GL_GOOGLE_include_directive : require
// The share of the sky that is visible from each pixel's surface: horizons in slices through the view direction, and
// the cosine-weighted sky between them in closed form (Jimenez et al. 2016, "Practical real-time strategies for
// accurate indirect occlusion", section 3), divided by that of an open plane, so that planes are not darkened. Surfaces
// farther than the radius do not count.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/pattern.glsl"
#include "shaders/render/surfel.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { OcclusionArgs args; };

const float kPi = 3.14159265;

// Sky from the view direction to a horizon at `angle` in a slice in which the normal is at `normal`, times 4.
float skyUpTo(float angle, float normal) { return cos(normal) + 2 * angle * sin(normal) - cos(2 * angle - normal); }

void main() {
  const RenderView view = frame.view;
  const ivec2 size = pictureSize(view);
  const uint place = threadIndex();
  if (place >= uint(size.x * size.y)) return;
  const ivec2 pixel = ivec2(place % uint(size.x), place / uint(size.x));
  const Surfel here = surfelAt(view, args.surfels, pixel);
  args.to.at[place] = 1;
  if (!isSurface(here)) return;
  const float pixelSize = divisorAt(view, here.depth) / pixelFocal(view);
  const float reach_px =
      min(kSkyRadius * frame.occlusionRadius / pixelSize, kHorizonReach * float(size.y));
  if (!(reach_px >= 1)) return;
  const float reach = reach_px * pixelSize;
  const vec3 toEye = -normalize(sightTo(view, here.position));
  const vec3 from =
      here.position + (kHorizonLift * frame.usualRadius + 1e-3 * pixelSize) * here.normal;
  const float turn = (float(rankOf(pixel)) + 0.5) / 16;

  float visible = 0, open = 0;
  for (uint slice = 0; slice < kSlices; ++slice) {
    const float angle = kPi * (float(slice) + turn) / float(kSlices);
    const vec2 along_px = vec2(cos(angle), sin(angle));
    const vec3 direction = vec3(along_px.x, -along_px.y, 0);
    const vec3 aside = direction - dot(direction, toEye) * toEye;
    const vec3 axis = normalize(cross(direction, toEye));
    const vec3 inSlice = here.normal - dot(here.normal, axis) * axis;
    const float share = length(inSlice);
    if (!(share > 1e-6)) continue;
    const float tilt = sign(dot(aside, inSlice)) * acos(clamp(dot(inSlice, toEye) / share, 0, 1));
    const vec2 lowest = cos(vec2(tilt + 0.5 * kPi, tilt - 0.5 * kPi));  // horizons of the open plane, cosines
    vec2 horizons = lowest;
    for (uint k = 0; k < kSliceSteps; ++k) {
      const float t = (float(k) + turn) / float(kSliceSteps);
      const vec2 step_px = max(reach_px * t * t, float(k + 1)) * along_px;
      for (uint side = 0; side < 2; ++side) {
        const Surfel there = surfelAt(view, args.surfels, pixel + ivec2(round(side == 0 ? step_px : -step_px)));
        if (!isSurface(there)) continue;
        const vec3 away = there.position - from;
        // Surfaces below the tangent plane hide nothing, though the pixel nearest to the slice may be beside it.
        if (dot(away, here.normal) <= 0) continue;
        const float squared = max(dot(away, away), 1e-30);
        const float weight = max(1 - squared / (reach * reach), 0);
        const float cosine = mix(lowest[side], dot(away, toEye) * inversesqrt(squared), weight);
        horizons[side] = max(horizons[side], cosine);
      }
    }
    const vec2 angles = acos(clamp(horizons, -1, 1)) * vec2(1, -1);
    visible += share * (skyUpTo(angles.x, tilt) + skyUpTo(angles.y, tilt));
    open += share * 4 * (cos(tilt) + tilt * sin(tilt));
  }
  if (open > 0) args.to.at[place] = clamp(visible / open, 0, 1);
}
