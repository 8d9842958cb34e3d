#ifndef PALPATE_LIB_EDIT_BUFFERS_GLSL
#define PALPATE_LIB_EDIT_BUFFERS_GLSL

#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_KHR_shader_subgroup_vote : require

#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/hash_update.glsl"

layout(buffer_reference) buffer Brushes;
layout(buffer_reference) buffer BrushTools;
layout(buffer_reference) buffer Founds;
layout(buffer_reference) buffer GivenChanges;
layout(buffer_reference) buffer Tables;
layout(buffer_reference) coherent buffer ResampleLists;
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Floats { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Places { vec3 at[]; };
#include "shaders/shared/edit.h"
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Brushes { Brush at[1]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer BrushTools { PlacedTool at[1]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Founds { Found at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer GivenChanges { GivenChange at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Tables { PointTables at[1]; };
// The last workgroup of a pass reads what the others have written.
layout(buffer_reference, scalar, buffer_reference_align = 8) coherent buffer ResampleLists {
  Resampling now;
  uint births[kBirthSlots];   // numbers of requests, by the ids of the points that made them
  uint claims[kClaimSlots];   // the smallest id that claims the slot; all bits if none does
  vec3 claimed[kClaimSlots];  // the position that it claims
  // The last insertion with this slot; while its stroke continues none is requested there again.
  vec3 grantedAt[kClaimSlots];
  uint grantedIn[kClaimSlots];  // number of the stroke; all bits for none
  PointRequest requests[];
};

bool isNull(Uints address) { return uvec2(address) == uvec2(0); }
bool examines(ResampleLists lists) { return uvec2(lists) != uvec2(0); }
bool resamples(Tables tables) { return tables.at[0].resamples != 0; }

bool isLocked(Tables tables, uint id) {
  if (isNull(tables.at[0].locked)) return false;
  return (tables.at[0].locked.at[id / 32] >> id % 32 & 1) != 0;
}

uint colorOf(Tables tables, uint id) {
  if (isNull(tables.at[0].colors)) return 0;
  return tables.at[0].colors.at[id];
}
// The point of the file from which it has its properties.
uint parentOf(Tables tables, uint id) {
  const uint firstNew = tables.at[0].firstNew;
  if (id < firstNew) return id;
  return tables.at[0].parents.at[id - firstNew];
}

// Weight of a point's lock, 0 to 1.
float lockOf(Tables tables, uint id) {
  Uints weights = tables.at[0].lockWeights;
  if (isNull(weights)) return 0.0;
  const uint point = id < weights.at[0] ? id : parentOf(tables, id);
  return float(weights.at[1 + point / 4] >> 8 * (point % 4) & 255) / 255.0;
}

#endif
