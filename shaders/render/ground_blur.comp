#version 460
#extension GL_GOOGLE_include_directive : require
// Removes the pattern of 4 x 4 cells from the shadow on the ground.
#include "shaders/lib/index.glsl"
#include "shaders/render/pattern.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { GroundShadowArgs args; };

void main() {
  const uint place = threadIndex();
  const int cells = int(args.map.cells);
  if (place >= uint(cells * cells)) return;
  const ivec2 at = ivec2(place % uint(cells), place / uint(cells));
  float sum = 0, shares = 0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      const ivec2 there = at + ivec2(x, y);
      if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, ivec2(cells)))) continue;
      sum += shareOf(ivec2(x, y)) * float(args.rough.at[there.y * cells + there.x]);
      shares += shareOf(ivec2(x, y));
    }
  args.shadow.at[place] = sum / (shares * kGroundUnit * float(kGroundDirections));
}
