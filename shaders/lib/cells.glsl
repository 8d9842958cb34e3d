// The cells around a position, and the points in their buckets: the candidates of a patch. They are visited in rounds
// of kContactWorkgroup cells, in the order of the cells and then of the points, so that the results are the same every
// time and with every method.
#ifndef PALPATE_LIB_CELLS_GLSL
#define PALPATE_LIB_CELLS_GLSL

#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/workgroup_scan.glsl"

shared uint cellStart[kContactWorkgroup];  // candidates before this cell's, in this round
shared uint cellFirst[kContactWorkgroup];  // its first point

struct CellBox {
  ivec3 low;
  uvec3 size;
  uint cells;
};

// `mostCells`: of one gather. More cells are possible only at a position so far out that it is rounded by whole cells.
CellBox boxAround(vec3 place, float reach, uint mostCells) {
  const float margin = 1.001 * reach;  // the position is rounded
  CellBox box;
  box.low = cellOf(args.cloud.grid, place - margin);
  box.size = uvec3(cellOf(args.cloud.grid, place + margin) - box.low + 1);
  box.cells = args.cloud.slots == 0 ? 0 : min(box.size.x * box.size.y * box.size.z, mostCells);
  return box;
}

// Exact for numbers of cells of one gather; GPUs have no instruction that divides integers.
uint wholeQuotient(uint number, uint by) { return uint((float(number) + 0.5) / float(by)); }

ivec3 cellAt(CellBox box, uint c) {
  const uint row = wholeQuotient(c, box.size.x), layer = wholeQuotient(row, box.size.y);
  return box.low + ivec3(c - row * box.size.x, row - layer * box.size.y, layer);
}

// Loads the round that begins with cell `first`: all invocations of a workgroup of kContactWorkgroup together. `count`:
// candidates of this invocation's cell, the one at scanIndex(). Returns the candidates of the round.
uint loadRound(CellBox box, uint first, out uint count) {
  const uint kMaxInCell = 1u << 22;  // keeps the sum within 32 bits
  const uint lane = scanIndex();
  uvec2 range = uvec2(0);
  if (first + lane < box.cells) range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cellAt(box, first + lane))];
  count = min(range.y - range.x, kMaxInCell);
  uint total;
  cellStart[lane] = workgroupExclusiveScan(count, total);
  cellFirst[lane] = range.x;
  barrier();
  return total;
}

// Stride that subsamples candidates to at most `most`.
uint strideOf(uint candidates, uint most) { return max(1, (candidates + most - 1) / most); }
uint takenOf(uint candidates, uint stride) { return (candidates + stride - 1) / stride; }

// Loop steps of a round in one workgroup alone, without those inside its scans.
uint patchSteps(uint taken) { return (taken + kContactWorkgroup - 1) / kContactWorkgroup + 1; }

// The last cell of the round whose candidates begin at or before `candidate`; unrolled, since a loop would count
// against the work budget.
uint cellOfCandidate(uint candidate) {
  uint cell = 0;
  if (cellStart[cell + 128] <= candidate) cell += 128;
  if (cellStart[cell + 64] <= candidate) cell += 64;
  if (cellStart[cell + 32] <= candidate) cell += 32;
  if (cellStart[cell + 16] <= candidate) cell += 16;
  if (cellStart[cell + 8] <= candidate) cell += 8;
  if (cellStart[cell + 4] <= candidate) cell += 4;
  if (cellStart[cell + 2] <= candidate) cell += 2;
  if (cellStart[cell + 1] <= candidate) cell += 1;
  return cell;
}

float patchReach(float radius) {
  precise float reach = radius + kPatchSlack * radius;
  return reach;
}

// Position of a point in a patch.
vec3 placeInPatch(vec3 position, vec3 hip, vec3 centre) {
  precise vec3 place = (position - hip) - centre;
  return place;
}
bool inReach(vec3 place, float reach) {
  precise float squared = place.x * place.x + place.y * place.y + place.z * place.z;
  precise float limit = reach * reach;
  return squared < limit;
}

#endif
