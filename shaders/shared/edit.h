#ifndef PALPATE_SHARED_EDIT_H
#define PALPATE_SHARED_EDIT_H
#include "shaders/shared/contact.h"
#include "shaders/shared/edit_log.h"

PALPATE_SHARED_BEGIN

// Rounds of the neighbour loop of one invocation while a normal is refitted. Past it the normal comes from the points
// seen so far; reached only where a hundred thousand points share a place.
const uint kRefitWorkBudget = 20000;

// Of the support radius: no point moves further in one tick, so that a resting proxy keeps its surface.
const float kLongestMove = 0.25f;

struct PushArgs {
  PALPATE_ADDRESS(Vec4s) positions;  // in and out
  PALPATE_ADDRESS(Vec4s) normals;    // w set to 1 where a point moved
  PALPATE_ADDRESS(ContactStates) state;
  uint count;
  float tau;         // spring length below which nothing yields, model units
  float beta;        // share of the way to its target that a point goes in one tick
  float toolRadius;  // model units
  float longestMove; // of one point in one tick, model units
  uint unused;
};
PALPATE_SIZE(PushArgs, 48);

struct CollectMovedArgs {
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) moved;       // places of the marked points in the hash order, in any order
  PALPATE_ADDRESS(Uints) movedCount;  // zero before
  uint count;
  uint unused;
};
PALPATE_SIZE(CollectMovedArgs, 32);

struct PlanRefitArgs {
  PALPATE_ADDRESS(Uints) movedCount;
  PALPATE_ADDRESS(Uints) groups;  // x, y, z of the indirect dispatch
  uint pointsPerGroup;
  uint largestAxis;
};
PALPATE_SIZE(PlanRefitArgs, 24);

struct RefitNormalsArgs {
  CloudView cloud;
  PALPATE_ADDRESS(Uints) moved;
  PALPATE_ADDRESS(Uints) movedCount;
  PALPATE_ADDRESS(EditEntries) entries;
  PALPATE_ADDRESS(Uints) head;
  uint capacityMask;  // entries in the ring, less one; a power of two less one
  float radius;       // support radius, model units
};
PALPATE_SIZE(RefitNormalsArgs, 96);

PALPATE_SHARED_END
#endif
