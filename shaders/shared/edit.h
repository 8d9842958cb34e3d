#ifndef PALPATE_SHARED_EDIT_H
#define PALPATE_SHARED_EDIT_H
#include "shaders/shared/brush.h"
#include "shaders/shared/contact.h"
#include "shaders/shared/edit_log.h"
#include "shaders/shared/hash_update.h"

PALPATE_SHARED_BEGIN

// Rounds of the loops over the neighbours of one place. Past it what follows comes from the points seen so far; reached
// only where a hundred thousand points share a place.
const uint kNeighbourWorkBudget = 20000;

// Of the support radius: no point moves further in one tick, so that a resting proxy keeps its surface.
const float kLongestMove = 0.25f;

// Cells that one workgroup looks through for points that a tool reaches: few, so that a surface that lies along them
// keeps no workgroup much longer than the others.
const uint kSelectCells = 64;

// The points that a brush reaches, and where it brings them.
struct SelectArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(PointMoves) moves;
  PALPATE_ADDRESS(Uints) marks;
  PALPATE_ADDRESS(TouchedBuckets) touched;
  PALPATE_ADDRESS(ContactStates) state;
  PALPATE_ADDRESS(Brushes) brush;
  PALPATE_ADDRESS(Uints) colors;  // RGBA8 by id; null where there are none
  uint mostMoves;
  uint cells;      // of the tool's box, along one side; 0: all slots from firstSlot on are looked at
  uint firstSlot;
  uint slots;
};
PALPATE_SIZE(SelectArgs, 128);

struct SmoothArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(PointMoves) moves;
  PALPATE_ADDRESS(Uints) marks;
  PALPATE_ADDRESS(TouchedBuckets) touched;
  PALPATE_ADDRESS(ContactStates) state;
  PALPATE_ADDRESS(Brushes) brush;
  uint mostMoves;
  uint unused;
};
PALPATE_SIZE(SmoothArgs, 112);

// A change as the host gives it; both states have the same number.
struct GivenChange {
  EditEntry from;
  EditEntry to;
};
PALPATE_SIZE(GivenChange, 72);

struct RestoreArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(PointMoves) moves;
  PALPATE_ADDRESS(Uints) marks;
  PALPATE_ADDRESS(TouchedBuckets) touched;
  PALPATE_ADDRESS(GivenChanges) changes;
  PALPATE_ADDRESS(Uints) colors;   // RGBA8 by id; null where there are none
  PALPATE_ADDRESS(Uints) parents;  // of the points from firstNew on
  uint mostMoves;
  uint firstNew;
  uint count;  // of changes
  uint unused;
};
PALPATE_SIZE(RestoreArgs, 128);

struct LogGoneArgs {
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(PointMoves) moves;
  PALPATE_ADDRESS(EditEntries) entries;
  PALPATE_ADDRESS(Uints) head;
  PALPATE_ADDRESS(Uints) colors;
  PALPATE_ADDRESS(Uints) parents;
  uint capacityMask;  // entries in the ring, less one; a power of two less one
  uint firstNew;
};
PALPATE_SIZE(LogGoneArgs, 56);

struct RefitNormalsArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) changed;
  PALPATE_ADDRESS(EditEntries) entries;
  PALPATE_ADDRESS(Uints) head;
  PALPATE_ADDRESS(Uints) colors;
  PALPATE_ADDRESS(Uints) parents;
  uint capacityMask;  // entries in the ring, less one; a power of two less one
  float radius;       // support radius, model units
  uint firstNew;
  uint unused;
};
PALPATE_SIZE(RefitNormalsArgs, 120);

PALPATE_SHARED_END
#endif
