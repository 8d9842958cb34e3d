// Compaction of an index after edits: the points of one half of the live cloud are copied without gaps into the other
// half, while edits continue in the first. Slices on a background queue copy every bucket; buckets that edits change
// meanwhile are noted (HashUpdate.dirty) and copied again at the end, on the touch queue, between two edits.
#ifndef PALPATE_SHARED_HASH_COMPACTION_H
#define PALPATE_SHARED_HASH_COMPACTION_H
#include "shaders/shared/hash_update.h"

PALPATE_SHARED_BEGIN

// Why a compaction failed; the front half is unchanged.
const uint kCompactionNoSlots = 1;   // the points do not fit; or a torn read of a bucket made it seem large
const uint kCompactionTooDirty = 2;  // edits changed more buckets than could be noted

// Workgroups that visit the noted buckets; loops cover the remainder.
const uint kPlanGroups = 16;

struct HashCompaction {
  uint head;          // first slot of the back half that the slices have not assigned to a bucket
  uint failed;        // kCompaction...
  uint loose;         // slots for the buckets that have outgrown their first copy, with spare ones
  uint tight;         // the same without spare ones
  uint given;         // slots of those assigned so far
  uint completed;     // not 0: the back half holds all points, and its index is complete
  uvec3 againGroups;  // one subgroup for each noted bucket
};
PALPATE_SIZE(HashCompaction, 36);

// Input of the next slice, written by the host: the slots to empty and the buckets to copy.
struct CompactionSlice {
  uvec2 slots;
  uvec2 buckets;
};
PALPATE_SIZE(CompactionSlice, 16);

struct CompactionArgs {
  CloudView from;
  PALPATE_ADDRESS(Vec4s) positions;  // these four are those of the back half
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(UVec2s) ranges;
  PALPATE_ADDRESS(Uints) capacities;
  PALPATE_ADDRESS(HashCompactions) state;
  PALPATE_ADDRESS(CompactionSlices) slice;  // for the copy
  PALPATE_ADDRESS(HashUpdates) update;      // these two are for the last passes
  PALPATE_ADDRESS(DirtyBuckets) dirty;
};
PALPATE_SIZE(CompactionArgs, 120);

PALPATE_SHARED_END
#endif
