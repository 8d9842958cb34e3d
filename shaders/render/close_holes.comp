#version 460
#extension GL_GOOGLE_include_directive : require
// Through a gap in a scan a few samples show surfaces far behind: the background, or the inside of the other side. Such
// a sample is enclosed: in each of eight directions a much nearer sample is close. It then takes the surface of the
// closest of them. Slits and notches are open in some direction and stay. The source sample is only recorded here, and
// looked up by later passes, so that no invocation reads what another one writes.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/view.glsl"

layout(push_constant, scalar) uniform Push { CloseHolesArgs args; };

const ivec2 kDirections[8] = ivec2[8](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1), ivec2(1, 1), ivec2(-1, -1),
                                      ivec2(1, -1), ivec2(-1, 1));

void main() {
  const uint place = threadIndex();
  const uvec2 size = frame.view.size_px;
  if (place >= size.x * size.y) return;
  const ivec2 at = ivec2(place % size.x, place / size.x);
  const float limit = uintBitsToFloat(args.depth.at[place]) - kHoleDepth * frame.usualRadius;
  const int reach = int(frame.holeReach_px);

  uint source = place;
  int shortest = reach + 1;
  bool enclosed = reach > 0;
  for (uint k = 0; k < 8 && enclosed; ++k) {
    enclosed = false;
    for (int step = 1; step <= reach && !enclosed; ++step) {
      const ivec2 p = at + step * kDirections[k];
      if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, ivec2(size)))) break;
      const uint there = uint(p.y) * size.x + uint(p.x);
      enclosed = uintBitsToFloat(args.depth.at[there]) < limit;
      if (!enclosed || step >= shortest) continue;
      shortest = step;
      source = there;
    }
  }
  args.source.at[place] = enclosed ? source : place;
}
