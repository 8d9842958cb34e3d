#ifndef PALPATE_SHARED_EDIT_LOG_H
#define PALPATE_SHARED_EDIT_LOG_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// Set in the id of a point that was removed.
const uint kPointGone = 0x80000000u;

// A point as an edit left it (PointState of engine/core/point_state.hpp). Entries of one tick name each point once and
// may be in any order; ticks are in order, so applying entries front to back gives the present cloud.
struct EditEntry {
  vec3 position;  // model units relative to the cloud's origin
  uint id;        // with kPointGone if it was removed
  vec3 normal;    // unit
  uint color;     // RGBA8; 0 if the cloud has no colours
  uint parent;    // the point from which it took its other properties; itself for a point of the file
};
PALPATE_SIZE(EditEntry, 36);

PALPATE_SHARED_END

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer EditEntries { EditEntry at[]; };
#endif
#endif
