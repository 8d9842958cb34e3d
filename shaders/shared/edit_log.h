#ifndef PALPATE_SHARED_EDIT_LOG_H
#define PALPATE_SHARED_EDIT_LOG_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// A point's new place, by its id. Entries of one tick name each point once and may stand in any order; ticks stand in
// order, so applying entries front to back gives the cloud as it is.
struct EditEntry {
  vec3 position;  // model units relative to the cloud's origin
  uint id;
  vec3 normal;  // unit
  uint unused;
};
PALPATE_SIZE(EditEntry, 32);

PALPATE_SHARED_END

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer EditEntries { EditEntry at[]; };
#endif
#endif
