#version 460
#extension GL_GOOGLE_include_directive : require
// Eye-space depth smoothed within the surface: a Gaussian weight of the distance on screen times one of the difference
// in depth from the plane through the sample (bilateral filter, Tomasi and Manduchi 1998), so that steps are kept. The
// slope of that plane is the gentler one of the two sides along each axis. Samples of the background do not change.
#include "shaders/lib/index.glsl"
#include "shaders/render/depth_slope.glsl"
#include "shaders/render/frame_block.glsl"

layout(push_constant, scalar) uniform Push { SmoothDepthArgs args; };

void main() {
  const uint place = threadIndex();
  const uvec2 size = frame.view.size_px;
  if (place >= size.x * size.y) return;
  const uint bits = args.depth.at[place];
  if (bits == kNoDepth) {
    args.smoothed.at[place] = bits;
    return;
  }
  const ivec2 at = ivec2(place % size.x, place / size.x);
  const float depth = uintBitsToFloat(bits);
  const vec2 slope = depthSlope(args.depth, size, at, depth);
  const int reach = int(frame.smooth_px);
  const float wide = 2.0 / float(reach * reach);  // the window ends at two standard deviations
  const float deep = 1 / (kSmoothBand * frame.usualRadius);
  float sum = 0, weights = 0;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      const float there = depthAt(args.depth, size, at + ivec2(x, y));
      const float off = there - depth - dot(slope, vec2(x, y));
      const float away = off * deep;
      if (!(away * away < 9)) continue;
      const float weight = exp(-float(x * x + y * y) * wide - 0.5 * away * away);
      sum += weight * off;
      weights += weight;
    }
  args.smoothed.at[place] = floatBitsToUint(depth + sum / weights);  // the sample itself has weight 1
}
