#version 460
#extension GL_GOOGLE_include_directive : require
// Water, passes 2 and 3: depth, thickness and cover, smoothed along the rows and then along the columns. Depths follow
// the narrow-range filter of Truong and Yuksel: what is far in front does not count, nor what is opposite of it, and
// what is far behind counts as a little behind, so that rims are round. The surface stays close to the particles.
// A pixel without a ball receives the depth of those beside it: the smoothed cover tells whether it is water.
#include "shaders/render/frame_block.glsl"
#include "shaders/render/water.glsl"

layout(constant_id = 1) const uint kAlongColumns = 0;

const float kBackground = 3.0e38;  // no depth of a surface is larger

struct Water {
  float depth;  // infinite: none
  vec2 amount;  // thickness in sides of the model, and cover
};
Water waterAt(ivec2 size, ivec2 pixel) {
  pixel = clamp(pixel, ivec2(0), size - 1);
  const uint place = uint(pixel.y * size.x + pixel.x);
  if (kAlongColumns != 0) {
    const uvec2 bits = args.across.at[place];
    return Water(uintBitsToFloat(bits.x), unpackHalf2x16(bits.y));
  }
  const uint bits = args.fronts.at[place];
  return Water(uintBitsToFloat(bits),
               vec2(float(args.sums.at[place]) / (args.unitsInLength * args.side), bits == kNoDepth ? 0 : 1));
}

// A neighbour's part in the depth; `opposite`: weight of the one on the other side.
void admit(inout float depth, inout float weight, inout float opposite, inout float nearest, inout float farthest,
           float rim, float band) {
  if (depth < nearest) {
    weight = opposite = 0;
  } else if (depth > farthest) {
    depth = rim;
  } else {
    nearest = min(nearest, depth - band);
    farthest = max(farthest, depth + band);
  }
}

void main() {
  const RenderView view = pictureView(frame.view);
  const ivec2 size = ivec2(view.size_px);
  const uint place = threadIndex();
  if (place >= uint(size.x * size.y)) return;
  const ivec2 at = ivec2(place % uint(size.x), place / uint(size.x));
  ivec2 step = ivec2(1, 0);
  if (kAlongColumns != 0) step = ivec2(0, 1);  // Mesa mistakes a specialised choice between vectors
  const Water here = waterAt(size, at);
  const bool isSurface = here.depth < kBackground;
  const float usual = 0.5 * (frame.depthMin + frame.depthMax);
  const float deviation = kWaterSmooth * ballAt(view, isSurface ? here.depth : usual);
  const int reach = int(min(ceil(kWaterWindow * deviation), float(kMaxWaterReach_px)));
  const float fall = -0.5 / (deviation * deviation);
  const float band = kWaterBand * args.radius, rim = here.depth + kWaterRim * args.radius;

  float nearest = here.depth - band, farthest = here.depth + band;
  float depths = isSurface ? here.depth : 0, depthWeights = isSurface ? 1 : 0;
  vec2 amounts = here.amount;
  float amountWeights = 1;
  for (int k = 1; k <= reach; ++k) {
    const Water one = waterAt(size, at - k * step), other = waterAt(size, at + k * step);
    const float weight = exp(fall * float(k * k));
    const float narrow = weight * weight * weight * weight;  // half of the deviation
    amounts += narrow * (one.amount + other.amount);
    amountWeights += 2 * narrow;
    vec2 depth = vec2(one.depth, other.depth), weights = vec2(weight);
    if (isSurface) {
      admit(depth.x, weights.x, weights.y, nearest, farthest, rim, band);
      admit(depth.y, weights.y, weights.x, nearest, farthest, rim, band);
    } else {
      weights = mix(vec2(0), weights, lessThan(depth, vec2(kBackground)));
    }
    if (weights.x > 0) depths += weights.x * depth.x;
    if (weights.y > 0) depths += weights.y * depth.y;
    depthWeights += weights.x + weights.y;
  }
  float depth = depthWeights > 0 ? depths / depthWeights : uintBitsToFloat(kNoDepth);
  if (kAlongColumns != 0) {
    const float front = uintBitsToFloat(args.fronts.at[place]);
    if (front < kBackground)
      depth = clamp(depth, front - kWaterNearer * args.radius, front + kWaterFarther * args.radius);
  }
  const uvec2 result = uvec2(floatBitsToUint(depth), packHalf2x16(amounts / amountWeights));
  if (kAlongColumns != 0) args.smoothed.at[place] = result;
  else args.across.at[place] = result;
}
