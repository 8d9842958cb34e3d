// Surface elements: depth and normal of one sample of each pixel of the picture, in eye space, for passes that look at
// the surface around a pixel.
#ifndef PALPATE_RENDER_SURFEL_GLSL
#define PALPATE_RENDER_SURFEL_GLSL
#include "shaders/render/view.glsl"

ivec2 pictureSize(RenderView view) { return ivec2(view.size_px / view.supersample); }
// The sample that stands for a pixel.
ivec2 sampleOfPixel(RenderView view, ivec2 pixel) { return pixel * int(view.supersample) + int(view.supersample / 2); }
// Pixels of the picture that one unit covers at depth 1.
float pixelFocal(RenderView view) { return view.focal_px / float(view.supersample); }

vec2 signsOf(vec2 v) { return mix(vec2(-1), vec2(1), greaterThanEqual(v, vec2(0))); }

// A unit vector in 32 bits (Cigolle et al. 2014, "A survey of efficient representations for independent unit vectors",
// octahedral).
uint packedUnit(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  return packSnorm2x16(n.z >= 0 ? n.xy : (1 - abs(n.yx)) * signsOf(n.xy));
}
vec3 unpackedUnit(uint bits) {
  const vec2 e = unpackSnorm2x16(bits);
  const float z = 1 - abs(e.x) - abs(e.y);
  return normalize(vec3(z >= 0 ? e : (1 - abs(e.yx)) * signsOf(e), z));
}

struct Surfel {
  float depth;  // infinite: no surface
  vec3 position, normal;
};
Surfel surfelAt(RenderView view, UVec2s surfels, ivec2 pixel) {
  const ivec2 size = pictureSize(view);
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size)))
    return Surfel(uintBitsToFloat(kNoDepth), vec3(0), vec3(0));
  const uvec2 bits = surfels.at[pixel.y * size.x + pixel.x];
  const float depth = uintBitsToFloat(bits.x);
  const vec2 place_px = vec2(sampleOfPixel(view, pixel)) + 0.5;
  return Surfel(depth, bits.x == kNoDepth ? vec3(0) : pointAt(view, place_px, depth), unpackedUnit(bits.y));
}
bool isSurface(Surfel s) { return !isinf(s.depth); }

// Two numbers of each pixel, at a sample: from the four pixels around it, mostly those whose depth is close to its own.
// 1 for numbers that `has` does not name.
vec2 atSample(RenderView view, Floats first, Floats second, bvec2 has, UVec2s surfels, uvec2 place, float depth) {
  const ivec2 size = pictureSize(view);
  const vec2 at = (vec2(place) - float(view.supersample / 2)) / float(view.supersample);
  const ivec2 low = ivec2(floor(at));
  const vec2 t = at - vec2(low);
  const int pixels = view.supersample == 1 ? 1 : 4;
  vec3 sum = vec3(0);
  for (int k = 0; k < pixels; ++k) {
    const ivec2 pixel = clamp(low + ivec2(k & 1, k >> 1), ivec2(0), size - 1);
    const uint index = uint(pixel.y * size.x + pixel.x);
    const uint bits = surfels.at[index].x;
    if (bits == kNoDepth) continue;
    const vec2 share = mix(1 - t, t, bvec2(k & 1, k >> 1));
    const float apart = abs(uintBitsToFloat(bits) - depth) * pixelFocal(view) / divisorAt(view, depth);  // pixels
    const float weight = (share.x * share.y + 1e-3) / (1 + apart * apart);
    sum += weight * vec3(has.x ? first.at[index] : 1, has.y ? second.at[index] : 1, 1);
  }
  return sum.z > 0 ? sum.xy / sum.z : vec2(1);
}

#endif
