#version 460
#extension GL_GOOGLE_include_directive : require
// Id and slot of each new point, in the order of their pixels: the lowest free ones. One invocation for each word of
// the masks; most have nothing to do, since the new points take the first free ones.
#include "shaders/lib/index.glsl"
#include "shaders/shared/fusion_passes.h"

layout(push_constant, scalar) uniform Push { ListFreeArgs args; };

uint lowestBit(uint mask) { return mask & (~mask + 1u); }

void main() {
  const uint word = threadIndex();
  if (word >= args.words) return;
  const uint last = args.pixelWords - 1;
  const uint wanted = args.newBefore.at[last] + bitCount(args.newPixels.at[last]);
  uint ids = args.freeIds.at[word];
  for (uint rank = args.idsBefore.at[word]; ids != 0 && rank < wanted; ++rank) {
    args.places.at[rank].x = word * kMaskBits + findLSB(ids);
    ids ^= lowestBit(ids);
  }
  args.freeIds.at[word] = ids;
  uint slots = args.emptySlots.at[word];
  if (word == args.words - 1) args.totals.now.points = args.slots - args.slotsBefore.at[word] - bitCount(slots);
  for (uint rank = args.slotsBefore.at[word]; slots != 0 && rank < wanted; ++rank) {
    args.places.at[rank].y = word * kMaskBits + findLSB(slots);
    slots ^= lowestBit(slots);
  }
}
