#ifndef PALPATE_SHARED_GATHER_H
#define PALPATE_SHARED_GATHER_H
#include "shaders/shared/contact.h"

PALPATE_SHARED_BEGIN

// One workgroup visits kGatherChunk candidates of a bucket at a time; each such chunk has its own slots in the patch.
const uint kGatherChunk = 64;
const uint kMaxSegments = kPatchMaxCells + kMaxPatchPoints / kGatherChunk;

// Points that one invocation of the brute gather visits. More give fewer counts to sum up, but too few workgroups on a
// small cloud.
const uint kBruteItems = 8;
const uint kBruteChunk = kBruteItems * kContactWorkgroup;

// A first patch that other workgroups have gathered, as the solve reads it: `segments` in order, each a run of points
// (first slot, number). Two vec4 a slot: position relative to the centre with the bits of the id, normal.
struct GatherHeader {
  vec3 centre;  // relative to the HIP
  uint segments;
  uint steps;     // cost of the gather in one workgroup alone, loop steps (patchSteps)
  uint thinned;   // not 0: candidates were subsampled
  uint finished;  // workgroups of a split gather that have finished; 0 between ticks
  vec3 hip;       // at the time of the indexed points (probe.glsl), for passes that gather by a plan
  uint unused[2];
};
PALPATE_SIZE(GatherHeader, 48);

// A cell of the gather with the candidates in its bucket: points first, first + stride, ...
struct GatherCell {
  ivec3 cell;
  uint first;
  uint stride;
  uint taken;    // candidates
  uint segment;  // of its first chunk; the next chunks follow
  uint unused;
};
PALPATE_SIZE(GatherCell, 32);

// What a plan writes for the launch of the gather.
const uint kPlanCounts = 0;    // 2 words for the host: cells, maximum candidates of a cell
const uint kPlanCommands = 1;  // a dispatch command of 3 words for every cell; zero groups for an empty one
const uint kPlanList = 2;      // only cells with candidates are listed, and one dispatch command covers them

struct GatherPlanArgs {
  CloudView cloud;
  PALPATE_ADDRESS(ContactPoses) pose;
  PALPATE_ADDRESS(ContactStates) state;
  PALPATE_ADDRESS(GatheredPatch) gathered;
  PALPATE_ADDRESS(GatherCells) cells;
  PALPATE_ADDRESS(Uints) launch;
  float radius;    // support radius, model units
  uint mostCells;  // capacity of the buffers
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
  PALPATE_ADDRESS(Uints) starts;  // for each chunk: points kept, then points kept before it; the last word is the sum
  float radius;                   // support radius, model units
  uint chunks;
  uint fill;        // 0: counts, 1: fills
  uint mostPoints;  // maximum; if more are in reach, they are subsampled evenly
};
PALPATE_SIZE(GatherBruteArgs, 104);

PALPATE_SHARED_END
#endif
