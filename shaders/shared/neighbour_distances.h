#ifndef PALPATE_SHARED_NEIGHBOUR_DISTANCES_H
#define PALPATE_SHARED_NEIGHBOUR_DISTANCES_H
#include "shaders/shared/spatial_hash.h"

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Distances { vec2 at[]; };
#endif

PALPATE_SHARED_BEGIN

const uint kMaxNearest = 32;  // neighbours whose distances are added up
// In place of a sum, in its first float: of a point that is examined now; that had too few neighbours in the widest
// radius; that had too many points to visit; that waits until others have been examined; that is left to a scan of all.
const float kExamined = -1.0f;
const float kSparse = -2.0f;
const float kCrowded = -3.0f;
const float kWaiting = -4.0f;
const float kLeft = -5.0f;
const uint kDistancePasses = 3;  // with the edge of a cell as radius, and each time twice as much
// Iterations of one point, as kEstimateWorkBudget; a neighbourhood on an even surface takes a twentieth of that.
const uint kDistanceWorkBudget = 2048;
const uint kScanWorkgroup = 256;

struct NeighbourDistancesArgs {
  CloudView cloud;
  PALPATE_ADDRESS(Distances) distances;  // in and out, by the point's id
  float radius;                          // of the first pass, model units
  uint neighbours;                       // 1 to kMaxNearest, fewer than there are points
};
PALPATE_SIZE(NeighbourDistancesArgs, 72);

struct ScanDistancesArgs {
  CloudView cloud;
  PALPATE_ADDRESS(Distances) distances;  // out, by the point's id
  PALPATE_ADDRESS(Uints) left;           // slots of the points, one for each workgroup
  uint neighbours;
  uint unused;
};
PALPATE_SIZE(ScanDistancesArgs, 80);

PALPATE_SHARED_END
#endif
