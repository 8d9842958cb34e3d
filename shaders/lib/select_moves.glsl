// Selects the points in reach of a brush and their moves; nothing is moved yet.
#ifndef PALPATE_LIB_SELECT_MOVES_GLSL
#define PALPATE_LIB_SELECT_MOVES_GLSL

#include "shaders/lib/brush_reach.glsl"
#include "shaders/lib/subgroup_reduce.glsl"
#include "shaders/lib/workgroup_scan.glsl"

shared uint cellStart[kMaxSelectCells];  // points in the preceding cells
shared uint cellFirst[kMaxSelectCells];  // first slot

// Whether the ball around the tool's reach intersects a cell; also true if it misses by less than the rounding of
// positions.
bool mayReach(HashGrid grid, ivec3 cell) {
  const vec3 center = (tool.middle - grid.origin) * grid.inverseCell;
  const float rounding = 0.01 + 1e-6 * max(abs(center.x), max(abs(center.y), abs(center.z)));
  const vec3 gap = max(vec3(0.0), max(vec3(cell) - center, center - vec3(cell + 1)));
  const float radius = tool.reach * grid.inverseCell * (1.0 + 1e-6) + rounding;
  return dot(gap, gap) < radius * radius;
}

// Records what else changes with a point that the brush moves.
void noteReached(uint id, vec3 position, FoundPoint found) {
  if (brushHas(brush, kPaintsPoints)) {
    args.tables.at[0].colors.at[id] = painted(brush, tool, position, found, colorOf(args.tables, id));
    return;
  }
  resetReach(id);
  noteFound(id, found);
}

// Adds the points' contributions to the measured surface under the tool. The whole subgroup calls it together.
void measure(bool counts, vec3 position, FoundPoint found) {
  MeasuredPoint point = MeasuredPoint(0, ivec3(0), 0);
  uint near = kOutsideSheet;
  if (counts) {
    if (isActedOn(found)) point = measured(brush, tool, found);
    near = entered(brush, tool, position, found);
  }
  const uint cell = near % kSheetCells, nearest = reduceMin(near);
  if (near != kOutsideSheet) atomicOr(args.update.at[0].seen[cell / 32], 1u << cell % 32);
  if (nearest != kOutsideSheet && subgroupElect()) atomicMin(args.update.at[0].nearest, nearest);
  if (!subgroupAny(point.weight != 0)) return;
  const int weights = reduceAdd(point.weight), heights = reduceAdd(point.height);
  const ivec3 normals = reduceAdd(point.normal);
  if (!subgroupElect()) return;
  atomicAdd(args.update.at[0].weights, uint(weights));
  for (uint k = 0; k < 3; ++k) atomicAdd(args.update.at[0].normals[k], uint(normals[k]));
  atomicAdd(args.update.at[0].heights, uint(heights));
}

// Whether a point in reach has no room for its step, with any brush but smooth.
bool isBlocked(vec4 position, vec4 normal, FoundPoint found) {
  if (!mayBlock(brush, found) || normal.w == kMarkGoes || !isActedOn(found)) return false;
  const vec3 free = brushed(brush, tool, position.xyz, normal.xyz, withRoom(found)).position;
  return isBlocked(brush, position.xyz, found, free);
}

// The whole subgroup calls it together.
void countBlocked(bool blocked) {
  const uint count = subgroupBallotBitCount(subgroupBallot(blocked));
  if (count > 0 && subgroupElect()) atomicAdd(args.update.at[0].blocked, count);
}

const uint kAnyCell = 0xffffffffu;

// Looks up the cells of workgroup `group` of `groups`: every `groups`-th of the brush's box, so that a surface along
// the box is shared by all workgroups. Returns the number of points to examine.
uint lookUpCells(uint group, uint groups) {
  const uint side = args.cells, lane = scanIndex();
  const ivec3 low = cellOf(args.cloud.grid, tool.middle - tool.reach);
  const uint c = group + lane * groups;
  uvec2 range = uvec2(0);
  if (lane < kMaxSelectCells && c < side * side * side) {
    const ivec3 cell = low + ivec3(c % side, c / side % side, c / (side * side));
    if (mayReach(args.cloud.grid, cell)) range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cell)];
  }
  uint total;
  const uint start = workgroupExclusiveScan(range.y - range.x, total);
  if (lane < kMaxSelectCells) {
    cellStart[lane] = start;
    cellFirst[lane] = range.x;
  }
  barrier();
  return total;
}

// Number of slots that workgroup `group` of `groups` examines.
uint slotsToLookAt(uint group, uint groups) {
  if (tool.acts == 0) return 0;
  if (args.cells > 0) return lookUpCells(group, groups);
  const uint before = group * gl_WorkGroupSize.x;
  return before < args.slots ? min(args.slots - before, gl_WorkGroupSize.x) : 0;
}

// The k-th of them; `cell`: of the brush's box, which must contain its point, or kAnyCell.
uint slotToLookAt(uint k, uint group, uint groups, out uint cell) {
  cell = kAnyCell;
  if (args.cells == 0) return args.firstSlot + group * gl_WorkGroupSize.x + k;
  uint owner = 0;
  for (uint step = kMaxSelectCells / 2; step > 0; step /= 2)
    if (cellStart[owner + step] <= k) owner += step;
  cell = group + owner * groups;
  return cellFirst[owner] + k - cellStart[owner];
}

// Another cell of the box may share the bucket: its points are taken with that cell.
bool standsIn(uint cell, vec3 position) {
  if (cell == kAnyCell) return true;
  const uint side = args.cells;
  const uvec3 inBox = uvec3(cellOf(args.cloud.grid, position) - cellOf(args.cloud.grid, tool.middle - tool.reach));
  return all(lessThan(inBox, uvec3(side))) && inBox.x + side * (inBox.y + side * inBox.z) == cell;
}

#endif
