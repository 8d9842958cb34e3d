// How the index of the drawn points follows edits, and finds the discs near them (engine/render/splat_index.hpp). Edits
// list the cells in which they add, remove, move or rotate a point. The disc of a point depends on the cells within its
// reach alone, and on the number of points in its own bucket.
#ifndef PALPATE_SHARED_SPLAT_INDEX_H
#define PALPATE_SHARED_SPLAT_INDEX_H
#include "shaders/shared/edit_log.h"
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// Cells farther than this from the first one are too far to be found by their distance from others: positions there are
// rounded by parts of a cell.
const int kSplatFarCell = 1 << 16;
// The box around a changed cell in which points may have visited it has at most so many layers of cells. One subgroup
// visits a layer.
const uint kSplatNearLayers = 9;
// Of a bucket near a changed cell with more points than this not all are visited.
const uint kSplatMostNearInBucket = 1u << 16;

// The cells that edits have changed since discs were measured last; several times if several points changed.
struct ChangedCells {
  uint count;
  uint everywhere;  // not 0: discs elsewhere may have changed, too
};
PALPATE_SIZE(ChangedCells, 8);

struct SplatIndexLists {
  PALPATE_ADDRESS(PointMoves) moves;  // these as in HashUpdateArgs
  PALPATE_ADDRESS(Uints) marks;
  PALPATE_ADDRESS(Uints) touched;
  PALPATE_ADDRESS(Uints) movesOf;
  PALPATE_ADDRESS(Uints) capacities;
  PALPATE_ADDRESS(CellLists) cells;
  PALPATE_ADDRESS(Uints) lastOf;  // per bucket: 1 + number of the last cell listed in it, counted from the load on
  uint mostMoves;
  uint mostCells;
};
PALPATE_SIZE(SplatIndexLists, 64);

// A range of the edit log that the index follows.
struct SplatFollowArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(SplatIndexListsAt) lists;
  PALPATE_ADDRESS(EditEntries) entries;  // from here on as in CatchUpArgs
  PALPATE_ADDRESS(Uints) latest;
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  uint firstSlot;
  uint slotMask;
  uint entryCount;
  uint pointCount;
  uint listedBefore;  // cells listed and forgotten
  uint unused;
};
PALPATE_SIZE(SplatFollowArgs, 128);

struct SplatNearArgs {
  CloudView cloud;
  PALPATE_ADDRESS(CellLists) cells;
  PALPATE_ADDRESS(Uints) lastOf;
  PALPATE_ADDRESS(Uints) reaches;  // these four as in SplatRadiusArgs
  PALPATE_ADDRESS(Uints) largest;
  PALPATE_ADDRESS(Uints) list;
  PALPATE_ADDRESS(Uints) count;  // number of points in `list`: one word
  uint listed;                   // number of listed cells
  uint listedBefore;
};
PALPATE_SIZE(SplatNearArgs, 112);

struct SplatForgetArgs {
  PALPATE_ADDRESS(CellLists) cells;
  PALPATE_ADDRESS(Uints) changed;  // out: no mark is left in the words of the cells' buckets
  HashGrid grid;
  uint listed;
  uint unused;
};
PALPATE_SIZE(SplatForgetArgs, 48);

PALPATE_SHARED_END
#endif
