#version 460
#extension GL_GOOGLE_include_directive : require
// Number of free ids and slots in each word of their masks.
#include "shaders/lib/index.glsl"
#include "shaders/shared/fusion_passes.h"

layout(push_constant, scalar) uniform Push { CountFreeArgs args; };

void main() {
  const uint word = threadIndex();
  if (word >= args.words) return;
  args.idCounts.at[word] = bitCount(args.freeIds.at[word]);
  args.slotCounts.at[word] = bitCount(args.emptySlots.at[word]);
}
