#ifndef PALPATE_LIB_EDIT_BUFFERS_GLSL
#define PALPATE_LIB_EDIT_BUFFERS_GLSL

#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_KHR_shader_subgroup_vote : require

#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/hash_update.glsl"

layout(buffer_reference) buffer Brushes;
layout(buffer_reference) buffer GivenChanges;
layout(buffer_reference) buffer Tables;
layout(buffer_reference) coherent buffer ResampleLists;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Floats { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Places { vec3 at[]; };
#include "shaders/shared/edit.h"
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Brushes { Brush at[1]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer GivenChanges { GivenChange at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Tables { PointTables at[1]; };
// The last workgroup of a pass reads what the others have written.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer ResampleLists {
  Resampling now;
  uint births[kMostBirths];   // numbers of wishes, by the ids that wished
  uint claims[kClaimSlots];   // the least id that wants a place; all bits where none does
  vec3 claimed[kClaimSlots];  // the place that it wants
  PointWish wishes[];
};

bool isNull(Uints address) { return uvec2(address) == uvec2(0); }
bool resamples(ResampleLists lists) { return uvec2(lists) != uvec2(0); }

UpdateLists listsOf(HashUpdates update, Uints capacities, Tables tables) {
  return UpdateLists(update, tables.at[0].moves, tables.at[0].marks, tables.at[0].touched, tables.at[0].movesOf,
                     capacities, tables.at[0].mostMoves);
}

uint colorOf(Tables tables, uint id) {
  if (isNull(tables.at[0].colors)) return 0;
  return tables.at[0].colors.at[id];
}
// The point that has its properties from the file itself.
uint parentOf(Tables tables, uint id) {
  const uint firstNew = tables.at[0].firstNew;
  if (id < firstNew) return id;
  return tables.at[0].parents.at[id - firstNew];
}

uint bucketAt(CloudView cloud, vec3 position) { return bucketOf(cloud.grid, cellOf(cloud.grid, position)); }

// The slot where a bucket has the point; kEmptySlot when it has not. The whole subgroup calls it together.
uint slotIn(CloudView cloud, uint bucket, uint id) {
  const uvec2 range = cloud.ranges.at[bucket];
  for (uint base = range.x; base < range.y; base += gl_SubgroupSize) {
    const uint slot = base + gl_SubgroupInvocationID;
    const uvec4 found =
        subgroupBallot(slot < range.y && floatBitsToUint(cloud.positions.at[min(slot, range.y - 1)].w) == id);
    if (any(notEqual(found, uvec4(0)))) return base + subgroupBallotFindLSB(found);
  }
  return kEmptySlot;
}

#endif
