// The neighbours of a position, visited once by one subgroup.
#ifndef PALPATE_LIB_NEIGHBOURS_GLSL
#define PALPATE_LIB_NEIGHBOURS_GLSL

const bool kWalkNormals = true;  // of all candidates: a later load would be a second wait
uint walkedInBucket() { return 0xffffffffu; }
#include "shaders/lib/neighbour_walk.glsl"

// The including file defines the processing of a neighbour at the offset `d`. One invocation of the subgroup calls it.
void visitNeighbour(uint id, vec3 normal, vec3 d);

// Visits all points nearer than `radius` to `center`, each once. The whole subgroup calls it together. `budget`: of
// work.
void visitNeighbours(vec3 center, float radius, uint budget) {
  beginWalk(center, radius);
  while (walkOn(center, radius, budget)) {
    [[unroll]] for (uint i = 0; i < kWalkedAtOnce; ++i)
      if (walkedNear[i])
        visitNeighbour(floatBitsToUint(walkedPositions[i].w), walkedNormals[i], walkedPositions[i].xyz - center);
  }
}

#endif
