// The cells of particles of matter, and those near a position: for the neighbour lists on the CPU and on the GPU
// (engine/matter/cell_grid.hpp). x varies fastest, then y.
#ifndef PALPATE_SHARED_MATTER_CELLS_H
#define PALPATE_SHARED_MATTER_CELLS_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// A box from 0 to `size`, cut into cells that are at least half as wide as the reach of its particles.
struct MatterCells {
  vec3 size;           // m
  uint periodic;       // a bit for each axis: what leaves through one face enters through the opposite one
  vec3 cellsPerMetre;  // 1 / m
  ivec3 cells;         // along each axis
};
PALPATE_SIZE(MatterCells, 40);

// Cells to each side of its own that the reach of a position covers, and the resulting number of rows of cells along x.
const int kCellsBeside = 2;
const int kRowsWide = 5;
const int kRowsAbout = 25;

// Images of the box beyond the borders of periodic axes: 0, 1 (itself) or 2 along each of them, x varying fastest.
const uint kImages = 27u;
const uint kItself = 13u;
const uint kNoImage = 3u;  // along an axis: beyond a border that is not periodic

PALPATE_FUNCTION bool isPeriodic(MatterCells box, int axis) { return ((box.periodic >> axis) & 1u) != 0u; }

// A position outside the box, or NaN, belongs to a cell at its border.
PALPATE_FUNCTION int cellAt(float place, float cellsPerMetre, int cells) {
  const float along = place * cellsPerMetre;
  // Written so that a NaN gives the first cell.
  if (!(along > 0.0f)) return 0;
  return along < float(cells) ? int(along) : cells - 1;
}
PALPATE_FUNCTION ivec3 cellOf(MatterCells box, vec3 place) {
  return ivec3(cellAt(place.x, box.cellsPerMetre.x, box.cells.x), cellAt(place.y, box.cellsPerMetre.y, box.cells.y),
               cellAt(place.z, box.cellsPerMetre.z, box.cells.z));
}
PALPATE_FUNCTION uint numberOf(MatterCells box, ivec3 cell) {
  return uint((cell.z * box.cells.y + cell.y) * box.cells.x + cell.x);
}

// A cell along an axis, which may be beyond the border, as the cell that it is an image of.
struct CellAlong {
  int cell;
  uint image;
};
PALPATE_FUNCTION CellAlong cellAlong(int cell, int cells, bool periodic) {
  CellAlong along;
  along.cell = cell < 0 ? cell + cells : cell >= cells ? cell - cells : cell;
  along.image = cell < 0 ? 0u : cell >= cells ? 2u : 1u;
  if (along.image != 1u && !periodic) along.image = kNoImage;
  return along;
}

// The cells along an axis around `cell` that belong to one image, from `begin` to before `end`; empty if they are
// equal.
struct CellRun {
  int begin;
  int end;
};
PALPATE_FUNCTION CellRun runAlong(int cell, int cells, bool periodic, uint image) {
  const int begin = cell - kCellsBeside;
  const int end = cell + kCellsBeside + 1;
  CellRun run;
  run.begin = image == 0u ? min(begin + cells, cells) : image == 1u ? max(begin, 0) : 0;
  run.end = image == 0u ? cells : image == 1u ? min(end, cells) : max(end - cells, 0);
  if (image != 1u && !periodic) run.end = run.begin;
  return run;
}

// Offset of a neighbour in an image, m.
PALPATE_FUNCTION vec3 shiftOf(MatterCells box, uint image) {
  return vec3(float(image % 3u), float(image / 3u % 3u), float(image / 9u)) * box.size - box.size;
}

PALPATE_FUNCTION float wrappedAlong(float place, float size, bool periodic) {
  return periodic ? place - size * floor(place / size) : place;
}
// The position inside the box of which a position beyond a periodic border is an image.
PALPATE_FUNCTION vec3 wrapped(MatterCells box, vec3 place) {
  return vec3(wrappedAlong(place.x, box.size.x, isPeriodic(box, 0)),
              wrappedAlong(place.y, box.size.y, isPeriodic(box, 1)),
              wrappedAlong(place.z, box.size.z, isPeriodic(box, 2)));
}

PALPATE_SHARED_END
#endif
