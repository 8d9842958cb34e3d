#ifndef PALPATE_LIB_EDIT_BUFFERS_GLSL
#define PALPATE_LIB_EDIT_BUFFERS_GLSL

#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/hash_update.glsl"

layout(buffer_reference) buffer Brushes;
layout(buffer_reference) buffer GivenChanges;
#include "shaders/shared/edit.h"
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Brushes { Brush at[1]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer GivenChanges { GivenChange at[]; };

bool isNull(Uints address) { return uvec2(address) == uvec2(0); }

uint colorOf(Uints colors, uint id) {
  if (isNull(colors)) return 0;
  return colors.at[id];
}
// `parents`: of the points from `firstNew` on; those before have their properties from the file.
uint parentOf(Uints parents, uint firstNew, uint id) {
  if (id < firstNew) return id;
  return parents.at[id - firstNew];
}

#endif
