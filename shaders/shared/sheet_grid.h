// A grid of cells around the surface under a hand, one bit each. An edit enters the points that it finds; from these
// cells follows the part of the surface that is connected with the surface under the hand, on which a brush acts: what
// else is within its ball, such as another limb, belongs to another part of the model.
#ifndef PALPATE_SHARED_SHEET_GRID_H
#define PALPATE_SHARED_SHEET_GRID_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

const uint kSheetSide = 16u;  // cells along each axis
const uint kSheetCells = kSheetSide * kSheetSide * kSheetSide;
const uint kSheetWords = kSheetCells / 32u;
const uint kOutsideSheet = 0xffffffffu;
const float kSheetSteps = 1048574.0f;  // distances are compared in so many steps, in the bits over those of a cell
// In cells: points are entered this far inside the solid, so that two solids whose surfaces face each other are not in
// adjacent cells, unless the gap between them is narrower than half a cell.
const float kSheetInside = 0.75f;

// Position in the grid at which a point is entered, in cells from its corner.
PALPATE_FORMULA PALPATE_VEC3 sheetPlace(PALPATE_VEC3 corner, Real cell, PALPATE_VEC3 position, PALPATE_VEC3 normal) {
  return (position - corner) / cell - Real(kSheetInside) * normal;
}

PALPATE_FORMULA bool isInSheet(PALPATE_VEC3 place) {
  const Real side = Real(kSheetSide);
  return place.x >= Real(0.0) && place.y >= Real(0.0) && place.z >= Real(0.0) && place.x < side && place.y < side &&
         place.z < side;
}

// Number of the cell at a position in the grid; outside of it, of the nearest cell.
PALPATE_FORMULA uint sheetCellAt(PALPATE_VEC3 place) {
  const Real most = Real(kSheetSide - 1u);
  const uint x = uint(min(most, max(Real(0.0), place.x))), y = uint(min(most, max(Real(0.0), place.y)));
  const uint z = uint(min(most, max(Real(0.0), place.z)));
  return (x + kSheetSide * (y + kSheetSide * z)) & (kSheetCells - 1u);
}

PALPATE_SHARED_END
#endif
