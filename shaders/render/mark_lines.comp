#version 460
#extension GL_GOOGLE_include_directive : require
// Lines in space, pass 1: each pixel gets the most opaque mark of the lines that cover it. A line is a strip of its
// width in pixels around the segment between its ends; coverage of a pixel follows from the distance of its middle to
// the segment, with a ramp of one pixel at the edge.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/view.glsl"

layout(push_constant, scalar) uniform Push { LineArgs args; };

// An end in the picture: pixels, and what is linear in the picture: the inverse of its depth, or that of an
// orthographic camera itself.
vec3 placeInPicture(RenderView view, vec3 p) {
  return vec3(sampleOf(view, p) / float(view.supersample), view.isOrthographic != 0 ? p.z : 1 / p.z);
}

void mark(RenderView view, uvec2 size, ivec2 pixel, vec3 a, vec3 b, RenderLine line) {
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(size)))) return;
  const vec2 way = b.xy - a.xy, off = vec2(pixel) + 0.5 - a.xy;
  const float share = clamp(dot(off, way) / max(dot(way, way), 1.0e-12), 0, 1);
  const float covered = clamp(0.5 * line.width_px + 0.5 - length(off - share * way), 0, 1) * min(line.width_px, 1);
  if (covered <= 0) return;
  const uint at = uint(pixel.y) * size.x + uint(pixel.x);
  const float surface = args.depthImage.at[at];
  const float here = mix(a.z, b.z, share);
  const bool hidden = surface > 0 && (view.isOrthographic != 0 ? surface < here : surface * here < 1);
  const float opacity = covered * float(line.color >> 24) / 255 * (hidden ? kHiddenLine : 1);
  const uint level = uint(255 * opacity + 0.5);
  if (level > 0) atomicMax(args.marks.at[at], level << 24 | (line.color & 0xFFFFFF));
}

void main() {
  const uint number = threadIndex() / kLineWalkers, walker = threadIndex() % kLineWalkers;
  if (number >= args.count) return;
  const RenderView view = frame.view;
  const uvec2 size = view.size_px / view.supersample;
  const RenderLine line = args.lines.at[number];
  const vec3 a = placeInPicture(view, line.from), b = placeInPicture(view, line.to);
  const float reach = 0.5 * line.width_px + 1;

  // Column by column if it is more horizontal than vertical, else row by row.
  const bool across = abs(b.x - a.x) >= abs(b.y - a.y);
  const vec2 p = across ? a.xy : a.yx, q = across ? b.xy : b.yx;
  const float slope = p.x == q.x ? 0 : (q.y - p.y) / (q.x - p.x);
  const float aside = reach * sqrt(1 + slope * slope);
  const int first = int(floor(min(p.x, q.x) - reach)), last = int(floor(max(p.x, q.x) + reach));
  for (int u = first + int(walker); u <= last; u += int(kLineWalkers)) {
    const float middle = p.y + slope * (float(u) + 0.5 - p.x);
    for (int v = int(floor(middle - aside)); v <= int(floor(middle + aside)); ++v)
      mark(view, size, across ? ivec2(u, v) : ivec2(v, u), a, b, line);
  }
}
