// Common parts of the passes of a compaction (shaders/shared/hash_compaction.h).
#ifndef PALPATE_LIB_HASH_COMPACTION_GLSL
#define PALPATE_LIB_HASH_COMPACTION_GLSL

#include "shaders/lib/hash_update.glsl"

layout(buffer_reference) buffer HashCompactions;
layout(buffer_reference) buffer CompactionSlices;
#include "shaders/shared/hash_compaction.h"
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer HashCompactions { HashCompaction at[1]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CompactionSlices { CompactionSlice at[1]; };

// Slots of a bucket, clamped to existing ones: a range that is read while an edit writes it may be torn.
uvec2 soundRange(uvec2 range, uint slots) {
  range.x = min(range.x, slots);
  range.y = clamp(range.y, range.x, slots);
  return range;
}

// Whether this many slots are left: for the buckets that have outgrown their first copy, with or without spare ones.
bool fits(HashCompactions state, uint wanted, uint slots) {
  return state.at[0].failed == 0 && state.at[0].head <= slots && wanted <= slots - state.at[0].head;
}

#endif
