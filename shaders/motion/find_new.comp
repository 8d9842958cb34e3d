#version 460
#extension GL_GOOGLE_include_directive : require
// The pixels that see a surface without a point of the map: 32 of them a word.
#include "shaders/lib/index.glsl"
#include "shaders/lib/fusion_buffers.glsl"

layout(push_constant, scalar) uniform Push { FindNewArgs args; };

shared uint newMask[kMaxMaskWords];

bool isCovered(FusionView view, uint pixel) {
  const uint column = pixel % view.width, row = pixel / view.width;
  return isCovered(args.covered.at[pixel], column > 0 ? args.covered.at[pixel - 1] : 0,
                   column + 1 < view.width ? args.covered.at[pixel + 1] : 0,
                   row > 0 ? args.covered.at[pixel - view.width] : 0,
                   row + 1 < view.height ? args.covered.at[pixel + view.width] : 0);
}

void main() {
  const uint local = gl_LocalInvocationIndex, words = gl_WorkGroupSize.x / kMaskBits;
  if (local < words) newMask[local] = 0;
  barrier();
  const uint pixel = threadIndex();
  if (pixel < args.pixels) {
    args.places.at[pixel] = uvec2(kEmptySlot);
    if (args.surfaces.at[pixel].depth > 0 && !isCovered(viewOf(args.view), pixel))
      atomicOr(newMask[local / kMaskBits], 1u << local % kMaskBits);
  }
  barrier();
  const uint word = (pixel - local) / kMaskBits + local;
  if (local >= words || word * kMaskBits >= args.pixels) return;
  args.newPixels.at[word] = newMask[local];
  args.counts.at[word] = bitCount(newMask[local]);
}
