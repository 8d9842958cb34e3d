#version 460
#extension GL_GOOGLE_include_directive : require
// Composites the Gaussians of a tile of pixels over what is there, front to back (Kerbl et al. 2023, section 6), with
// the colours that are encoded for a screen, as they were trained. A workgroup lists the Gaussians of its bin that
// touch its tile, loads some of them at a time, of which each subgroup visits those that touch its part of the tile,
// and ends when all of its pixels are complete. The depth of a pixel is that at which half of the light is blocked.
#include "shaders/lib/index.glsl"
#include "shaders/lib/workgroup_scan.glsl"
#include "shaders/render/color.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/shared/gaussians.h"

layout(constant_id = 1) const uint kTile = kGaussianTile;
const uint kBlock = kTile / kGaussianBlocks;  // side of the pixels of an invocation
const uint kPixels = kBlock * kBlock;

layout(push_constant, scalar) uniform Push { GaussianBlendArgs args; };

struct Listed {
  uint gaussian;
};
shared Listed listed[kGaussianListed];
shared vec4 centers[kGaussianWorkgroup];  // position, opacity, depth
shared vec4 shapes[kGaussianWorkgroup];   // shape, blue
shared vec4 colors[kGaussianWorkgroup];   // slope, red, green

struct Pixel {
  vec3 color;  // times opacity
  float transmittance;
  uint depth;
};

void load(uint slot, uint gaussian) {
  const vec2 redGreen = unpackHalf2x16(args.projected.at[gaussian].redGreen);
  centers[slot] = vec4(args.projected.at[gaussian].center_px, args.projected.at[gaussian].opacity,
                       args.projected.at[gaussian].depth);
  shapes[slot] =
      vec4(args.projected.at[gaussian].shape, unpackHalf2x16(args.projected.at[gaussian].blue).x);
  colors[slot] = vec4(args.projected.at[gaussian].slope, redGreen);
}

void blend(uint slot, vec2 place_px, float nearDepth, inout Pixel pixel) {
  const vec4 center = centers[slot], shape = shapes[slot], color = colors[slot];
  const vec2 d = place_px - center.xy;
  const vec2 deviations = vec2(shape.x * (d.x - shape.y * d.y), shape.z * d.y);
  const float alpha = min(kGaussianMostOpaque, center.z * exp(-0.5 * dot(deviations, deviations)));
  if (!(alpha >= kGaussianFaintest) || pixel.transmittance < kGaussianClosed) return;
  const float left = pixel.transmittance * (1 - alpha);
  if (pixel.transmittance > 0.5 && left <= 0.5)
    pixel.depth = floatBitsToUint(max(center.w + dot(color.xy, deviations), nearDepth));
  pixel.color += pixel.transmittance * alpha * vec3(color.zw, shape.w);
  pixel.transmittance = left;
}

// Squared distance in standard deviations from the nearest position on a line along y, at `x` and from `low` to `high`.
float nearestAt(float x, float low, float high, vec3 shape) {
  const float across = shape.x * shape.y;  // the minimum along y of (shape.x (x - shape.y y))^2 + (shape.z y)^2
  const float y = clamp(across * shape.x * x / (across * across + shape.z * shape.z), low, high);
  const vec2 d = vec2(shape.x * (x - shape.y * y), shape.z * y);
  return dot(d, d);
}

// Whether a Gaussian is not too faint somewhere in a rectangle, given from its centre. `reach`: squared.
bool touches(vec2 low, vec2 high, vec3 shape, float reach) {
  const bvec2 around = bvec2(low.x <= 0 && high.x >= 0, low.y <= 0 && high.y >= 0);
  // The nearest position of a rectangle is on its border, along y at either end of x, and along x likewise.
  float least = min(nearestAt(low.x, low.y, high.y, shape), nearestAt(high.x, low.y, high.y, shape));
  for (uint end = 0; end < 2; ++end) {
    const float y = end == 0 ? low.y : high.y;
    const vec2 d = vec2(shape.x * (clamp(shape.y * y, low.x, high.x) - shape.y * y), shape.z * y);
    least = min(least, dot(d, d));
  }
  return all(around) || least <= 1.001 * reach;
}

// Of this invocation's word of a bin: the bits of the Gaussians that touch a rectangle.
uint touchingOf(uint word, uint firstRank, vec2 low, vec2 high) {
  uint touching = 0;
  for (uint rest = word; rest != 0; rest &= rest - 1) {
    const uint bit = uint(findLSB(rest));
    const vec4 box = args.boxes.at[2 * (firstRank + bit)], shape = args.boxes.at[2 * (firstRank + bit) + 1];
    if (touches(low - box.xy, high - box.xy, shape.xyz, shape.w)) touching |= 1u << bit;
  }
  return touching;
}

// Position of an invocation's block in the tile (Morton 1966): those of a subgroup of any size are a rectangle.
uvec2 blockOf(uint invocation) {
  return uvec2((invocation & 1) | (invocation & 4) >> 1 | (invocation & 16) >> 2,
               (invocation & 2) >> 1 | (invocation & 8) >> 2 | (invocation & 32) >> 3);
}

// Of the loaded Gaussians from `first` on, one for each invocation of the subgroup: those that touch its rectangle.
uvec2 touchingSlots(uint first, uint loaded, vec2 low, vec2 high) {
  const uint slot = first + gl_SubgroupInvocationID;
  bool isTouching = false;
  if (slot < loaded) {
    const vec4 center = centers[slot];
    isTouching = touches(low - center.xy, high - center.xy, shapes[slot].xyz, squaredReach(center.z));
  }
  return subgroupBallot(isTouching).xy;
}

void write(RenderView view, uvec2 at_px, Pixel pixel) {
  const float alpha = 1 - pixel.transmittance;
  for (uint k = 0; k < view.supersample * view.supersample; ++k) {
    const uvec2 place = at_px * view.supersample + uvec2(k % view.supersample, k / view.supersample);
    const uint at = place.y * view.size_px.x + place.x;
    const uvec2 packed = args.shaded.at[at];
    const vec4 behind = vec4(unpackHalf2x16(packed.x), unpackHalf2x16(packed.y));  // light times opacity, and opacity
    const vec3 encoded = behind.a > 0 ? toEncoded(behind.rgb / behind.a) : vec3(0);
    const float both = alpha + pixel.transmittance * behind.a;
    const vec3 color = (pixel.color + pixel.transmittance * behind.a * encoded) / both;
    const vec3 light = both * toLinear(clamp(color, 0, 1));
    args.shaded.at[at] = uvec2(packHalf2x16(light.rg), packHalf2x16(vec2(light.b, both)));
    args.depth.at[at] = pixel.depth;
  }
}

void main() {
  const uint tile = workgroupIndex();
  if (tile >= args.tiles) return;
  const RenderView view = frame.view;
  const uvec2 size = view.size_px / view.supersample;
  const uvec2 corner = kTile * uvec2(tile % args.tilesAcross, tile / args.tilesAcross);
  const uvec2 inBins = corner / args.binSide_px;
  const uint bin = (inBins.y * args.binsAcross + inBins.x) * args.words;
  const uint me = scanIndex();
  const vec2 low = vec2(corner) + 0.5, high = low + float(kTile - 1);  // pixel centres of the tile
  const uint firstMate = gl_SubgroupID * gl_SubgroupSize, lastMate = firstMate + gl_SubgroupSize - 1;
  const vec2 ownLow = low + vec2(kBlock * blockOf(firstMate));
  const vec2 ownHigh = low + vec2(kBlock * blockOf(lastMate) + kBlock - 1);

  uvec2 at_px[kPixels];
  Pixel pixels[kPixels];
  [[unroll]] for (uint k = 0; k < kPixels; ++k) {
    at_px[k] = corner + kBlock * blockOf(me) + uvec2(k % kBlock, k / kBlock);
    pixels[k] = Pixel(vec3(0), all(lessThan(at_px[k], size)) ? 1.0 : 0.0, kNoDepth);
  }

  bool isComplete = false;
  for (uint first = 0; first < args.words && !isComplete; first += kGaussianWords * kGaussianWorkgroup) {
    uint words[kGaussianWords];
    uint own = 0;
    [[unroll]] for (uint k = 0; k < kGaussianWords; ++k) {
      const uint word = first + me * kGaussianWords + k;
      words[k] = word < args.words ? touchingOf(args.bins.at[bin + word], 32 * word, low, high) : 0;
      own += bitCount(words[k]);
    }
    uint total;
    const uint before = workgroupExclusiveScan(own, total);
    for (uint done = 0; done < total && !isComplete; done += kGaussianListed) {
      uint at = before - done;  // before the list, it wraps around
      [[unroll]] for (uint k = 0; k < kGaussianWords; ++k)
        for (uint rest = words[k]; rest != 0; rest &= rest - 1, ++at)
          if (at < kGaussianListed)
            listed[at].gaussian = args.order.at[32 * (first + me * kGaussianWords + k) + uint(findLSB(rest))];
      barrier();
      const uint count = min(total - done, kGaussianListed);
      for (uint begin = 0; begin < count && !isComplete; begin += kGaussianWorkgroup) {
        if (begin + me < count) load(me, listed[begin + me].gaussian);
        float most = 0;
        [[unroll]] for (uint k = 0; k < kPixels; ++k) most = max(most, pixels[k].transmittance);
        const bool isOpen = most >= kGaussianClosed;
        uint open;
        workgroupExclusiveCount(isOpen, open);  // and the barrier after loading
        isComplete = open == 0;
        const uint loaded = subgroupBallot(isOpen) != uvec4(0) ? min(kGaussianWorkgroup, count - begin) : 0;
        for (uint from = 0; from < loaded; from += gl_SubgroupSize) {
          const uvec2 touching = touchingSlots(from, loaded, ownLow, ownHigh);
          for (uint part = 0; part < 2; ++part)
            for (uint rest = touching[part]; rest != 0; rest &= rest - 1) {
              const uint slot = from + 32 * part + uint(findLSB(rest));
              [[unroll]] for (uint k = 0; k < kPixels; ++k)
                blend(slot, vec2(at_px[k]) + 0.5, view.nearDepth, pixels[k]);
            }
        }
        barrier();
      }
    }
  }
  [[unroll]] for (uint k = 0; k < kPixels; ++k)
    if (all(lessThan(at_px[k], size)) && pixels[k].transmittance < 1) write(view, at_px[k], pixels[k]);
}
