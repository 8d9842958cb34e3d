#version 460
#extension GL_GOOGLE_include_directive : require
// The nodes of a soft body that a press may hold: those of cells with skin within its radius, in the order of their
// numbers.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_press.h"

layout(push_constant, scalar) uniform Push { SoftHoldArgs args; };

#include "shaders/lib/soft_boxes.glsl"

shared uint before[2][kMatterBlock];
shared uint blocksInReach[kMatterBlock];

// Number of the workgroup's invocations up to this one for which `says` is set. All call this together.
uint countedUpTo(bool says) {
  const uint local = gl_LocalInvocationIndex;
  barrier();
  before[0][local] = says ? 1 : 0;
  uint from = 0;
  for (uint step = 1; step < kMatterBlock; step *= 2) {
    barrier();
    before[1 - from][local] = before[from][local] + (local >= step ? before[from][local - step] : 0);
    from = 1 - from;
  }
  barrier();
  return before[from][local];
}

// After countedUpTo(): the total. Eight steps end in the half in which they began.
uint countedInAll() { return before[0][kMatterBlock - 1]; }

bool nodeIsInReach(uint node, vec3 middle, float radius) {
  for (uint k = 0; node < args.nodeCount && k < 8; ++k)
    if (cellIsInReach(slotAbout(node, k), middle, radius)) return true;
  return false;
}

void main() {
  const uint press = workgroupIndex(), local = gl_LocalInvocationIndex;
  if (press >= args.counts.at[0] || args.presses.at[press].same != 0) return;
  const uint row = args.presses.at[press].row;
  const vec3 middle = args.presses.at[press].place;
  const float radius = args.presses.at[press].radius;
  uint found = 0;
  for (uint begin = 0; begin < args.blocks; begin += kMatterBlock) {
    const uint block = begin + local;
    const bool hit = block < args.blocks && isInReach(middle, radius, args.blockBoxes.at[kBoxVec4s * block].xyz,
                                                      args.blockBoxes.at[kBoxVec4s * block + 1].xyz);
    const uint upTo = countedUpTo(hit), hits = countedInAll();
    if (hit) blocksInReach[upTo - 1] = block;
    barrier();
    for (uint k = 0; k < hits; ++k) {
      const uint node = blocksInReach[k] * kMatterBlock + local;
      const bool near = nodeIsInReach(node, middle, radius);
      const uint place = found + countedUpTo(near);
      if (near) args.held.at[row * args.heldStride + place - 1].node = node;
      found += countedInAll();
    }
  }
  if (local == 0) args.counts.at[1 + row] = found;
}
