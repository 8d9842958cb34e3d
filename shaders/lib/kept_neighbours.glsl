// The neighbours of a position, kept by one subgroup so that it can visit them repeatedly.
#ifndef PALPATE_LIB_KEPT_NEIGHBOURS_GLSL
#define PALPATE_LIB_KEPT_NEIGHBOURS_GLSL

#extension GL_KHR_shader_subgroup_ballot : require

const bool kWalkNormals = false;
uint walkedInBucket() { return 0xffffffffu; }
#include "shaders/lib/neighbour_walk.glsl"
#include "shaders/lib/subgroup_meet.glsl"

// Neighbours that a workgroup keeps, each subgroup its part: at least as many as a step of its walk may find.
const uint kKeptNeighbours = kWalkedAtOnce * gl_WorkGroupSize.x;

shared vec4 keptNeighbours[kKeptNeighbours];  // offset; w: bits of the slot
shared uint keptIds[kKeptNeighbours];

uint neighboursKept;  // by this subgroup
bool allAreKept;      // all neighbours visited so far, in this call
bool visitedBefore;   // the visited neighbours were kept by the previous call
bool allAreSeen;      // false: the budget ended before the neighbours did

vec3 keptOffset(uint at) { return keptNeighbours[at].xyz; }
uint keptSlot(uint at) { return floatBitsToUint(keptNeighbours[at].w); }

// The including file defines the processing of a neighbour, the one kept at `at`. One invocation of the subgroup calls
// it.
void visitNeighbour(uint at);

// Makes what all invocations have written to shared memory visible to the subgroup.
void subgroupShares() {
  subgroupMemoryBarrierShared();
  subgroupMeet();
}

// Visits all points nearer than `radius` to `center`, each once. The whole subgroup calls it together. `budget`: of
// work. `again`: the same position as in the last call, whose neighbours may still be kept.
void visitNeighbours(vec3 center, float radius, uint budget, bool again) {
  const uint most = kKeptNeighbours / gl_NumSubgroups;
  const uint first = gl_SubgroupID * most;
  visitedBefore = again && allAreKept;
  allAreKept = true;
  if (!visitedBefore) {
    neighboursKept = 0;
    beginWalk(center, radius);
  }
  bool goesOn = !visitedBefore;
  while (true) {
    uvec4 near[kWalkedAtOnce];
    uint found = 0;
    [[unroll]] for (uint i = 0; i < kWalkedAtOnce; ++i) near[i] = uvec4(0);
    if (goesOn) goesOn = walkOn(center, radius, budget);
    if (goesOn)
      [[unroll]] for (uint i = 0; i < kWalkedAtOnce; ++i) {
        near[i] = subgroupBallot(walkedNear[i]);
        found += subgroupBallotBitCount(near[i]);
      }
    if (!goesOn || neighboursKept + found > most) {
      subgroupShares();
      for (uint i = gl_SubgroupInvocationID; i < neighboursKept; i += gl_SubgroupSize) visitNeighbour(first + i);
      subgroupShares();
      if (!goesOn) {
        if (!visitedBefore) allAreSeen = walkedAll();
        return;
      }
      neighboursKept = 0;
      allAreKept = false;
    }
    [[unroll]] for (uint i = 0; i < kWalkedAtOnce; ++i) {
      if (walkedNear[i]) {
        const uint at = first + neighboursKept + subgroupBallotExclusiveBitCount(near[i]);
        keptNeighbours[at] = vec4(walkedPositions[i].xyz - center, uintBitsToFloat(walkedSlots[i]));
        keptIds[at] = floatBitsToUint(walkedPositions[i].w);
      }
      neighboursKept += subgroupBallotBitCount(near[i]);
    }
  }
}

#endif
