#ifndef PALPATE_SHARED_PATCH_H
#define PALPATE_SHARED_PATCH_H
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// The patch from which the host continues while the GPU is late: all points within kCarriedReach support radii of its
// centre. A surface at a position uses one support radius around it, so the hand may move by the rest before it reaches
// the border. More reach costs points; with less, forces end at the border sooner.
const float kCarriedReach = 2.5f;
const uint kMaxCarriedPoints = 2048;   // if more are in reach they are subsampled evenly, and `thinned` is set
const uint kCarriedCellsPerSide = 16;  // visited at most; if smaller cells would need more, the reach is reduced

struct CarriedHead {
  uint count;    // points
  uint thinned;  // not 0: neighbours were subsampled
  uint unused[2];
};
PALPATE_SIZE(CarriedHead, 16);

struct PatchFetchArgs {
  CloudView cloud;
  PALPATE_ADDRESS(Vec4s) centre;  // xyz: position in the index, at the time of its points; w: the points' age, s
  PALPATE_ADDRESS(FetchedPatch) fetched;  // 2 vec4 per point, as in the live cloud: position and id, normal
  PALPATE_ADDRESS(NearPoints) near;       // numbers of the points in reach; used by the pass alone
  PALPATE_ADDRESS(Vec4s) velocities;      // if points move: as in shaders/shared/motion.h
  float reach;                            // model units
  uint mostCells;
};
PALPATE_SIZE(PatchFetchArgs, 96);

PALPATE_SHARED_END
#endif
