// The neighbours of a place, visited once by one subgroup.
#ifndef PALPATE_LIB_NEIGHBOURS_GLSL
#define PALPATE_LIB_NEIGHBOURS_GLSL

const bool kWalkNormals = true;  // of all candidates: to ask for them later would be to wait twice
#include "shaders/lib/neighbour_walk.glsl"

// Whoever includes this says what to do with a neighbour, which is `d` away. One invocation of the subgroup calls it.
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
