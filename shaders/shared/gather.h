#ifndef PALPATE_SHARED_GATHER_H
#define PALPATE_SHARED_GATHER_H
#include "shaders/shared/contact.h"

PALPATE_SHARED_BEGIN

// One workgroup visits so many candidates of a bucket at once; each such chunk has slots of its own in the patch.
const uint kGatherChunk = 64;
const uint kMaxSegments = kPatchMaxCells + kMaxPatchPoints / kGatherChunk;

// Points that one invocation of the brute gather visits. More make fewer counts to add up, and too few workgroups on
// a small cloud.
const uint kBruteItems = 8;
const uint kBruteChunk = kBruteItems * kContactWorkgroup;

// A first patch that other workgroups have gathered, as the solve finds it: `segments` in order, each a run of points
// (first slot, number). Two vec4 a slot: place relative to the centre with the bits of the id, normal.
struct GatherHeader {
  vec3 centre;  // relative to the HIP
  uint segments;
  uint steps;     // what the gather costs where one workgroup does it alone, loop steps (patchSteps)
  uint thinned;   // not 0: only every so-manyth candidate was taken
  uint finished;  // workgroups of a split gather that are done; 0 between ticks
  vec3 hip;       // among the points as the index has them (probe.glsl), for passes that gather by a plan
  uint unused[2];
};
PALPATE_SIZE(GatherHeader, 48);

// A cell of the gather with the candidates that its bucket holds: points first, first + stride, ...
struct GatherCell {
  ivec3 cell;
  uint first;
  uint stride;
  uint taken;    // candidates
  uint segment;  // of its first chunk; the next chunks follow
  uint unused;
};
PALPATE_SIZE(GatherCell, 32);

// What a plan tells those who launch the gather.
const uint kPlanCounts = 0;    // 2 words for the host: cells, most candidates of one
const uint kPlanCommands = 1;  // a dispatch command of 3 words for every cell; no groups where it is empty
const uint kPlanList = 2;      // only cells with candidates are listed, and one dispatch command covers them

struct GatherPlanArgs {
  CloudView cloud;
  PALPATE_ADDRESS(ContactPoses) pose;
  PALPATE_ADDRESS(ContactStates) state;
  PALPATE_ADDRESS(GatheredPatch) gathered;
  PALPATE_ADDRESS(GatherCells) cells;
  PALPATE_ADDRESS(Uints) launch;
  float radius;    // support radius, model units
  uint mostCells;  // that the buffers hold
  uint plan;       // kPlan...
  uint unused;
};
PALPATE_SIZE(GatherPlanArgs, 112);

struct GatherBucketsArgs {
  CloudView cloud;
  PALPATE_ADDRESS(ContactPoses) pose;
  PALPATE_ADDRESS(GatheredPatch) gathered;
  PALPATE_ADDRESS(GatherCells) cells;
  uint firstCell;  // of this dispatch
  float radius;    // support radius, model units
};
PALPATE_SIZE(GatherBucketsArgs, 88);

struct GatherBruteArgs {
  CloudView cloud;
  PALPATE_ADDRESS(ContactPoses) pose;
  PALPATE_ADDRESS(ContactStates) state;
  PALPATE_ADDRESS(GatheredPatch) gathered;
  PALPATE_ADDRESS(Uints) starts;  // of every chunk: points kept, then points kept before it; the last word is the sum
  float radius;                   // support radius, model units
  uint chunks;
  uint fill;        // 0: counts, 1: fills
  uint mostPoints;  // taken, evenly, where more are in reach
};
PALPATE_SIZE(GatherBruteArgs, 104);

PALPATE_SHARED_END
#endif
