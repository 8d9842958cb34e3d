// Compaction of an index that has followed edits: the points of one half of the live cloud stand without gaps in the
// other, while edits go on in the first. Slices on a queue of the background copy every bucket; those that edits change
// meanwhile are noted (HashUpdate.dirty) and copied again at the end, on the touch queue, between two edits.
#ifndef PALPATE_SHARED_HASH_COMPACTION_H
#define PALPATE_SHARED_HASH_COMPACTION_H
#include "shaders/shared/hash_update.h"

PALPATE_SHARED_BEGIN

// Why a compaction did not come out; the front half is as it was.
const uint kCompactionNoSlots = 1;   // the points do not fit; or a torn read of a bucket made it seem large
const uint kCompactionTooDirty = 2;  // edits changed more buckets than could be noted

// Workgroups that visit the noted buckets; loops cover what is beyond.
const uint kPlanGroups = 16;

struct HashCompaction {
  uint head;          // first slot of the back half that the slices have given to no bucket
  uint failed;        // kCompaction...
  uint loose;         // slots for the buckets that have outgrown their first copy, with some to spare
  uint tight;         // the same without
  uint given;         // of those slots, so far
  uint completed;     // not 0: the back half holds all points, and its index is whole
  uvec3 againGroups;  // one subgroup a noted bucket
};
PALPATE_SIZE(HashCompaction, 36);

// What the next slice does, as the host says: the slots that it empties and the buckets that it copies.
struct CompactionSlice {
  uvec2 slots;
  uvec2 buckets;
};
PALPATE_SIZE(CompactionSlice, 16);

struct CompactionArgs {
  CloudView from;
  PALPATE_ADDRESS(Vec4s) positions;  // these four of the back half
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(UVec2s) ranges;
  PALPATE_ADDRESS(Uints) capacities;
  PALPATE_ADDRESS(HashCompactions) state;
  PALPATE_ADDRESS(CompactionSlices) slice;  // for the copy
  PALPATE_ADDRESS(HashUpdates) update;      // these two for the passes that make an end
  PALPATE_ADDRESS(DirtyBuckets) dirty;
};
PALPATE_SIZE(CompactionArgs, 120);

PALPATE_SHARED_END
#endif
