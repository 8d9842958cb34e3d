#version 460
#extension GL_GOOGLE_include_directive : require
// Water, pass 4: the smoothed depths, averaged once more over a small square around each pixel, without what is far
// from it: rows and columns by themselves leave streaks.
#include "shaders/render/frame_block.glsl"
#include "shaders/render/water.glsl"

void main() {
  const RenderView view = pictureView(frame.view);
  const ivec2 size = ivec2(view.size_px);
  const uint place = threadIndex();
  if (place >= uint(size.x * size.y)) return;
  const ivec2 at = ivec2(place % uint(size.x), place / uint(size.x));
  const uvec2 bits = args.smoothed.at[place];
  if (bits.x == kNoDepth) {
    args.across.at[place] = bits;
    return;
  }
  const float here = uintBitsToFloat(bits.x), band = kWaterBand * args.radius;
  const int reach = int(min(ceil(kWaterTidy * ballAt(view, here)), float(kMaxWaterTidy_px)));
  float depths = 0, count = 0;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      const ivec2 there = clamp(at + ivec2(x, y), ivec2(0), size - 1);
      const float depth = uintBitsToFloat(args.smoothed.at[uint(there.y * size.x + there.x)].x);
      if (!(abs(depth - here) <= band)) continue;
      depths += depth - here;
      ++count;
    }
  args.across.at[place] = uvec2(floatBitsToUint(here + depths / count), bits.y);
}
