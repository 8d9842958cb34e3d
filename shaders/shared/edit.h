#ifndef PALPATE_SHARED_EDIT_H
#define PALPATE_SHARED_EDIT_H
#include "shaders/shared/brush.h"
#include "shaders/shared/contact.h"
#include "shaders/shared/edit_log.h"
#include "shaders/shared/hash_update.h"
#include "shaders/shared/resample.h"

PALPATE_SHARED_BEGIN

// What the loops over the neighbours of one place may cost (lib/neighbour_walk.glsl). Past it what follows comes from
// the points seen so far; reached only where a hundred thousand points share a place.
const uint kNeighbourWorkBudget = 20000;
// The same for those that decide whether points come or go, who walk over their neighbours several
// times: so many candidates at most, or cells, whatever the size of a subgroup. Past it points decide by what they have
// seen, and no new one is requested: only where thousands share a place, and those are merged with the ones that are
// seen.
const uint kMaxExamined = 8192;

// Cells that one workgroup searches for points that a brush reaches: as few as keep so many workgroups busy, within
// these bounds. Fewer workgroups leave a GPU idle, more come and go for nothing.
const uint kSelectWorkgroups = 528u;
const uint kFewestSelectCells = 64u, kMaxSelectCells = 256u;  // at most one an invocation

// In the w of a normal between two ticks: the point is merged into a neighbour with the next edit.
const float kMarkGoes = 3.0f;
// Bits of the place where a point rested that was never there.
const uint kNeverRested = 0xffffffffu;
// In the w of a fitted normal: the point is as it was given, and is not to be examined.
const float kNotExamined = -1.0f;
// New points in one tick. They get their ids in the order of the points that request them, by comparing each with each.
// Where more are requested none come, and in the next tick half of the requests count.
const uint kMaxBirths = 1024;
// In memory; no workgroup has an array of this length, to which glslang would give this one's layout.
const uint kBirthSlots = kMaxBirths + 2;

// A point as the stroke found it that moved it last.
struct Found {
  vec3 position;
  uint stroke;  // 0: none has
  vec3 normal;
  float thick;  // how far under it the far sheet was seen last, model units; kUnseen
};
PALPATE_SIZE(Found, 32);

// What an edit knows of points by their ids; null where it is not kept. Places for `ids` points.
struct PointTables {
  PALPATE_ADDRESS(Uints) colors;     // RGBA8
  PALPATE_ADDRESS(Uints) parents;    // of the points from firstNew on
  PALPATE_ADDRESS(Floats) spacings;  // target, of the points before firstNew, model units
  PALPATE_ADDRESS(Places) rests;     // where points stood as loaded; of later ones, half way between their ends
  PALPATE_ADDRESS(Floats) reaches;   // of the points from firstNew on: how far others may come from there
  PALPATE_ADDRESS(Founds) founds;
  PALPATE_ADDRESS(Brushes) brush;
  PALPATE_ADDRESS(BrushTools) tool;
  PALPATE_ADDRESS(Uints) examined;  // tick in which a point was last examined
  PALPATE_ADDRESS(ResampleLists) lists;
  PALPATE_ADDRESS(PointMoves) moves;
  PALPATE_ADDRESS(Uints) marks;
  PALPATE_ADDRESS(Uints) touched;
  PALPATE_ADDRESS(Uints) movesOf;
  uint firstNew;
  uint ids;
  uint mostMoves;  // that there is room for; as many requests
  uint unused;
};
PALPATE_SIZE(PointTables, 128);

// What a point that was examined requests for the next tick: at least to be examined again.
struct PointRequest {
  vec3 position;  // of the point
  uint id;
  vec3 place;    // of the new point
  uint inserts;  // not 0: it requests one
  vec3 normal;   // of that, and so on
  uint color;
  uint parent;
  uint other;   // id of the point on the other side of the gap
  float reach;  // how far others may come from there
};
PALPATE_SIZE(PointRequest, 60);

struct Resampling {
  uint requests;
  uint births;  // new points that come with the next edit
  uint nextId;
  uint tick;
  uint thinning;  // only requests of every 2^thinning-th point for a new one count
};
const uint kResamplingBytes = 20;
PALPATE_SIZE(Resampling, kResamplingBytes);

// What happens to the requests of the last tick.
const uint kRecallsNothing = 0;
const uint kRecallsRequests = 1;  // they become moves
const uint kForgetsRequests = 2;

// The points that a brush reaches, and where it brings them.
struct CollectArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) capacities;
  PALPATE_ADDRESS(BrushTools) tool;
  PALPATE_ADDRESS(Brushes) brush;
  PALPATE_ADDRESS(Tables) tables;
  uint recalls;  // kRecalls...
  uint cells;    // of the brush's box, along one side; 0: slots from firstSlot on are examined
  uint firstSlot;
  uint slots;
};
PALPATE_SIZE(CollectArgs, 112);

// Workgroups that visit these cells or slots; those beyond carry out the requests.
PALPATE_FUNCTION uint selectGroups(uint cells, uint slots) {
  if (cells == 0u) return (slots + kUpdateWorkgroup - 1u) / kUpdateWorkgroup;
  const uint all = cells * cells * cells;
  const uint each = max(kFewestSelectCells, min(kMaxSelectCells, all / kSelectWorkgroups));
  return (all + each - 1u) / each;
}

struct SmoothArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) capacities;
  PALPATE_ADDRESS(BrushTools) tool;
  PALPATE_ADDRESS(Brushes) brush;
  PALPATE_ADDRESS(Tables) tables;
};
PALPATE_SIZE(SmoothArgs, 96);

// What the last pass of an edit does besides: it reports to the host what the edit came to, and empties the counters.
struct EditEnd {
  PALPATE_ADDRESS(Uints) report;      // of the HashUpdate; null in passes that are not the last
  PALPATE_ADDRESS(Uints) resampling;  // of the Resampling; null where there is none
  PALPATE_ADDRESS(Uints) empty;       // counters as they begin
};
PALPATE_SIZE(EditEnd, 24);

// After the index has followed: normals as they were fitted, and the requests that were carried out are dropped.
struct SettleArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) changed;
  PALPATE_ADDRESS(Vec4s) fitted;
  PALPATE_ADDRESS(Uints) head;  // of the log
  PALPATE_ADDRESS(ResampleLists) lists;
  EditEnd end;
};
PALPATE_SIZE(SettleArgs, 120);

// New requests, and which of those for new points are granted.
struct RequestArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) changed;
  PALPATE_ADDRESS(Vec4s) fitted;
  PALPATE_ADDRESS(Tables) tables;
  PALPATE_ADDRESS(ResampleLists) lists;
  EditEnd end;
  float radius;  // support radius, model units
  uint most;     // requests that there is room for
};
PALPATE_SIZE(RequestArgs, 128);

// Target spacings, measured once on the cloud as it was loaded.
struct SpacingArgs {
  CloudView cloud;
  PALPATE_ADDRESS(Tables) tables;
  float radius;  // support radius, model units
  uint counts;   // not 0: finds out which points count, in `examined`; 0: measures
};
PALPATE_SIZE(SpacingArgs, 72);

// A change as the host gives it; both states have the same number.
struct GivenChange {
  EditEntry from;
  EditEntry to;
};
PALPATE_SIZE(GivenChange, 72);

// After the update, what it leaves to do.
const uint kRestoreFinishes = 1;
// A point that does not stand where its change says stays as it is; without this all of the changes fail then.
const uint kRestoreOffered = 2;
// In the id of `from`: the change was left out.
const uint kChangeLeftOut = 0xffffffffu;

struct RestoreArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) capacities;
  PALPATE_ADDRESS(GivenChanges) changes;
  PALPATE_ADDRESS(Tables) tables;
  PALPATE_ADDRESS(ResampleLists) lists;
  uint count;  // of changes
  uint flags;  // kRestore...
};
PALPATE_SIZE(RestoreArgs, 104);

struct RefitNormalsArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) changed;
  PALPATE_ADDRESS(Vec4s) fitted;  // out: normal of every changed point; w: its target spacing, or kNotExamined
  PALPATE_ADDRESS(EditEntries) entries;
  PALPATE_ADDRESS(Uints) head;
  PALPATE_ADDRESS(Tables) tables;
  PALPATE_ADDRESS(ResampleLists) lists;
  uint capacityMask;  // entries in the ring, less one; a power of two less one
  float radius;       // support radius, model units
};
PALPATE_SIZE(RefitNormalsArgs, 120);

PALPATE_SHARED_END
#endif
