#ifndef PALPATE_SHARED_EDIT_H
#define PALPATE_SHARED_EDIT_H
#include "shaders/shared/brush.h"
#include "shaders/shared/contact.h"
#include "shaders/shared/edit_log.h"
#include "shaders/shared/hash_update.h"
#include "shaders/shared/resample.h"

PALPATE_SHARED_BEGIN

// Maximum cost of the loops over the neighbours of one position (lib/neighbour_walk.glsl). Beyond it the results use
// the points visited so far; reached only where a hundred thousand points share a position.
const uint kNeighbourWorkBudget = 20000;
// The same for the loops that decide whether points are added or removed, which visit the neighbours several times:
// maximum candidates, or cells, for any subgroup size. Beyond it points decide by the neighbours visited, and no new
// point is requested: only where thousands share a position, and those are merged with the visited ones.
const uint kMaxExamined = 8192;

// Cells that one workgroup searches for points in reach of a brush: as few as keep this many workgroups busy, within
// these bounds. Fewer workgroups leave a GPU idle, more are started for nothing.
const uint kSelectWorkgroups = 528u;
const uint kFewestSelectCells = 64u, kMaxSelectCells = 256u;  // at most one for each invocation

// In the w of a normal between two ticks: the next edit merges the point into a neighbour.
const float kMarkGoes = 3.0f;
// Bits of the rest position of an id that no point has had yet.
const uint kNeverRested = 0xffffffffu;
// In an entry of `examined`, over the lower bits of a tick: the edit of this tick has examined the point;
// the point had no room to move in this edit, or in an earlier one after which it was not examined.
const uint kIsExamined = 0x40000000u, kIsBlocked = 0x80000000u, kTickBits = 0x3fffffffu;
// In the w of a fitted normal: the point stays as it was given, and is not examined.
const float kNotExamined = -1.0f;
// New points in one tick. They get their ids in the order of the points that request them, by comparing each with each.
// If more are requested none is created, and in the next tick half of the requests count.
const uint kMaxBirths = 1024;
// Length in memory; no workgroup array has this length, or glslang would give it the layout of this one.
const uint kBirthSlots = kMaxBirths + 2;

// A point as it was found by the stroke that moved it last.
struct Found {
  vec3 position;
  uint stroke;  // 0: not moved by a stroke
  vec3 normal;
  float room;  // how far it may go on; while carved: from there down to the far sheet when last seen; model units
};
PALPATE_SIZE(Found, 32);

// Tables of an edit by the points' ids; null if a table is not kept. They hold `ids` points.
struct PointTables {
  PALPATE_ADDRESS(Uints) colors;     // RGBA8
  PALPATE_ADDRESS(Uints) parents;    // of the points from firstNew on
  PALPATE_ADDRESS(Floats) spacings;  // target, of the points before firstNew, model units
  PALPATE_ADDRESS(Places) rests;    // positions as loaded; for later points, half way between the rests of the two ends
  PALPATE_ADDRESS(Floats) reaches;  // of the points from firstNew on: how far from them new points may be created
  PALPATE_ADDRESS(Founds) founds;
  PALPATE_ADDRESS(Brushes) brush;
  PALPATE_ADDRESS(BrushTools) tool;
  PALPATE_ADDRESS(Uints) examined;  // tick in which a point was last examined, or had no room, with bits of which
  PALPATE_ADDRESS(Uints) carried;   // packedCarried() of a point when it was last examined; 0: not determined
  PALPATE_ADDRESS(ResampleLists) lists;
  PALPATE_ADDRESS(PointMoves) moves;
  PALPATE_ADDRESS(Uints) marks;
  PALPATE_ADDRESS(Uints) touched;
  PALPATE_ADDRESS(Uints) movesOf;
  PALPATE_ADDRESS(Uints) locked;  // a bit for each id: brushes leave the point as it is
  // Number of weights, then a byte for each of these ids: weight of the point's lock. Later points have their parents'.
  PALPATE_ADDRESS(Uints) lockWeights;
  uint firstNew;
  uint ids;
  uint mostMoves;  // capacity of the list; the same for requests
  uint resamples;  // 0: points look ahead, but none is inserted or merged
};
PALPATE_SIZE(PointTables, 152);

// Request of an examined point for the next tick: at least to be examined again.
struct PointRequest {
  vec3 position;  // of the point
  uint id;
  vec3 place;    // of the new point
  uint inserts;  // not 0: a new point is requested
  vec3 normal;   // of the new point, like `color`, `parent` and `reach`
  uint color;
  uint parent;
  uint other;   // id of the point on the other side of the gap
  float reach;  // how far from it other new points may be created
  // The new point as the last stroke that moved any of the two ends found it.
  vec3 found;
  vec3 foundNormal;
};
PALPATE_SIZE(PointRequest, 84);

struct Resampling {
  uint requests;
  uint births;  // new points of the next edit
  uint nextId;
  uint tick;
  uint thinning;  // only every 2^thinning-th point's request for a new point counts
  uint blocked;   // the last stroke with points that had no room to move
};
const uint kResamplingBytes = 24;
PALPATE_SIZE(Resampling, kResamplingBytes);

// What happens to the requests of the last tick.
const uint kRecallsNothing = 0;
const uint kRecallsRequests = 1;  // turns them into moves
const uint kForgetsRequests = 2;

// The points in reach of a brush, and their moves.
struct CollectArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) capacities;
  PALPATE_ADDRESS(BrushTools) tool;
  PALPATE_ADDRESS(Brushes) brush;
  PALPATE_ADDRESS(Tables) tables;
  uint recalls;  // kRecalls...
  uint cells;    // along one side of the brush's box; 0: slots from firstSlot on are examined
  uint firstSlot;
  uint slots;
};
PALPATE_SIZE(CollectArgs, 112);

// Workgroups that visit these cells or slots; those after them carry out the requests.
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

// Additional task of the last pass of an edit: it reports the result to the host, and resets the counters.
struct EditEnd {
  PALPATE_ADDRESS(Uints) report;      // copy of the HashUpdate; null in all passes but the last
  PALPATE_ADDRESS(Uints) resampling;  // copy of the Resampling; null without resampling
  PALPATE_ADDRESS(Uints) empty;       // initial values of the counters
};
PALPATE_SIZE(EditEnd, 24);

// After the index update: writes the fitted normals, and drops the requests that were carried out.
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

// What moved points see ahead, new requests, and the granted ones among those for new points.
struct RequestArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) changed;
  PALPATE_ADDRESS(Vec4s) fitted;
  PALPATE_ADDRESS(Tables) tables;
  PALPATE_ADDRESS(ResampleLists) lists;
  EditEnd end;
  float radius;  // support radius, model units
  uint most;     // capacity for requests
};
PALPATE_SIZE(RequestArgs, 128);

// Target spacings, measured once on the cloud as loaded.
struct SpacingArgs {
  CloudView cloud;
  PALPATE_ADDRESS(Tables) tables;
  float radius;  // support radius, model units
  uint counts;   // not 0: marks the points that count, in `examined`; 0: measures
};
PALPATE_SIZE(SpacingArgs, 72);

// A change given by the host; both states have the same id.
struct GivenChange {
  EditEntry from;
  EditEntry to;
};
PALPATE_SIZE(GivenChange, 72);

// Finishes the remaining work after the update.
const uint kRestoreFinishes = 1;
// A point that is not at the position of its change stays as it is; without this flag all changes fail then.
const uint kRestoreOffered = 2;
// In the id of `from`: the change was dropped.
const uint kChangeLeftOut = 0xffffffffu;

struct PlacePointsArgs {
  PALPATE_ADDRESS(Vec4s) positionsIn;  // of a half of the cloud, or as there, of given points
  PALPATE_ADDRESS(Vec4s) normalsIn;
  PALPATE_ADDRESS(Uints) colorsIn;      // of given points; null: of a half of the cloud
  PALPATE_ADDRESS(Vec4s) positionsOut;  // by id
  PALPATE_ADDRESS(Vec4s) normalsOut;
  PALPATE_ADDRESS(Uints) changed;  // a bit for each id, the first one in the lowest bit
  PALPATE_ADDRESS(Tables) tables;
  uint count;
  uint unused;
};
PALPATE_SIZE(PlacePointsArgs, 64);

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
  uint capacityMask;  // entries in the ring minus one; their number is a power of two
  float radius;       // support radius, model units
};
PALPATE_SIZE(RefitNormalsArgs, 120);

PALPATE_SHARED_END
#endif
