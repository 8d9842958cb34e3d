#version 460
#extension GL_GOOGLE_include_directive : require
// Water, pass 1: the nearest ball at each pixel, and the sum of their thickness as far as what is not water. A ball is
// larger than the volume of its particle, so that it counts by its share. A few invocations walk a ball's pixels.
#include "shaders/render/disc.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/shown.glsl"
#include "shaders/render/water.glsl"

void main() {
  const RenderView samples = frame.view;
  const RenderView view = pictureView(samples);
  const uint point = threadIndex() / kWaterWalkers;
  const int walker = int(threadIndex() % kWaterWalkers);
  if (point >= args.count || isHidden(point)) return;
  const vec3 center = toEye(view, args.positions.at[point].xyz - view.eye);
  const float radius = ballAt(view, center.z) * divisorAt(view, center.z) / view.focal_px;
  const float shallow = center.z - radius;
  if (!(shallow >= view.nearDepth)) return;
  const float deep = divisorAt(view, center.z + radius);
  const vec2 x = projectedInterval(center.x - radius, center.x + radius, divisorAt(view, shallow), deep);
  const vec2 y = projectedInterval(-center.y - radius, -center.y + radius, divisorAt(view, shallow), deep);
  const vec2 low = view.center_px + view.focal_px * vec2(x.x, y.x);
  const vec2 high = view.center_px + view.focal_px * vec2(x.y, y.y);
  const vec2 middle = clamp(0.5 * (low + high), vec2(-2e6), vec2(2e6)), half_ = vec2(kWidestBall_px / 2);
  const ivec2 first = max(ivec2(floor(max(low, middle - half_))), ivec2(0));
  const ivec2 last = min(ivec2(floor(min(high, middle + half_ - 1))), ivec2(view.size_px) - 1);
  if (any(greaterThan(first, last))) return;

  const float thinner = args.radius / radius;  // a ball that was widened keeps its volume
  const float units = args.unitsInLength * args.share * thinner * thinner * thinner;
  const int width = last.x - first.x + 1, walkers = int(kWaterWalkers);
  const ivec2 stride = ivec2(walkers % width, walkers / width);
  ivec2 pixel = first + ivec2(walker % width, walker / width);
  while (pixel.y <= last.y) {
    const vec3 from = rayFrom(view, vec2(pixel) + 0.5), ray = rayThrough(view, vec2(pixel) + 0.5);
    const float squared = dot(ray, ray), depth = dot(center - from, ray) / squared;
    const vec3 off = from + depth * ray - center;
    const float inside = radius * radius - dot(off, off);
    if (inside > 0) {
      const float thick = sqrt(inside / squared), front = depth - thick;
      const ivec2 there = sampleOfPixel(samples, pixel);
      const uint behind = args.source.at[uint(there.y) * samples.size_px.x + uint(there.x)];
      const float end = min(depth + thick, uintBitsToFloat(args.depth.at[behind]));
      if (front < end) {
        const uint place = uint(pixel.y) * view.size_px.x + uint(pixel.x);
        atomicMin(args.fronts.at[place], floatBitsToUint(front));
        atomicAdd(args.sums.at[place], uint(round(units * sqrt(squared) * (end - front))));
      }
    }
    pixel += stride;
    if (pixel.x > last.x) pixel += ivec2(-width, 1);
  }
}
