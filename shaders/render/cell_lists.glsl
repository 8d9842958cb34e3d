#ifndef PALPATE_CELL_LISTS_GLSL
#define PALPATE_CELL_LISTS_GLSL
// Buffers of shaders/shared/splat_index.h.
#include "shaders/lib/hash_update.glsl"

layout(buffer_reference) buffer CellLists;
layout(buffer_reference) buffer SplatIndexListsAt;
#include "shaders/shared/splat_index.h"
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer CellLists {
  ChangedCells about;
  ivec3 at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer SplatIndexListsAt { SplatIndexLists at[1]; };

#endif
