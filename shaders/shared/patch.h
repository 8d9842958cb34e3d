#ifndef PALPATE_SHARED_PATCH_H
#define PALPATE_SHARED_PATCH_H
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// The patch that the host goes on with while the GPU is late: all points within kCarriedReach support radii of its
// centre. A surface at a place takes one support radius of it, so the hand may move the rest before the border. More
// reach costs points, less costs forces that end at the border.
const float kCarriedReach = 2.5f;
const uint kMaxCarriedPoints = 2048;   // where more are in reach they are thinned evenly, and the patch says so
const uint kCarriedCellsPerSide = 16;  // visited at most; smaller cells than allow for that make the reach smaller

struct CarriedHead {
  uint count;    // points
  uint thinned;  // not 0: only every so-manyth was taken
  uint unused[2];
};
PALPATE_SIZE(CarriedHead, 16);

struct PatchFetchArgs {
  CloudView cloud;
  PALPATE_ADDRESS(Vec4s) centre;          // xyz: among the points as the index has them; w: how old they are, s
  PALPATE_ADDRESS(FetchedPatch) fetched;  // 2 vec4 per point, as the live cloud has them: position and id, normal
  PALPATE_ADDRESS(NearPoints) near;       // numbers of the points in reach; for the pass alone
  PALPATE_ADDRESS(Vec4s) velocities;      // where points move: as shaders/shared/motion.h has them
  float reach;                            // model units
  uint mostCells;
};
PALPATE_SIZE(PatchFetchArgs, 96);

PALPATE_SHARED_END
#endif
