#ifndef PALPATE_SHARED_EDIT_H
#define PALPATE_SHARED_EDIT_H
#include "shaders/shared/contact.h"
#include "shaders/shared/edit_log.h"

PALPATE_SHARED_BEGIN

// Rounds of the neighbour loop of one point while its normal is refitted. Past it the normal comes from the points seen so
// far; reached only where a thousand points share a place.
const uint kRefitWorkBudget = 20000;

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

struct RefitNormalsArgs {
  CloudView cloud;
  PALPATE_ADDRESS(EditEntries) entries;
  PALPATE_ADDRESS(Uints) head;
  uint capacityMask;  // entries in the ring, less one; a power of two less one
  float radius;       // support radius, model units
};
PALPATE_SIZE(RefitNormalsArgs, 72);

PALPATE_SHARED_END
#endif
