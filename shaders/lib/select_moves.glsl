// Which points a brush reaches, and where it brings them: nothing is moved yet.
#ifndef PALPATE_LIB_SELECT_MOVES_GLSL
#define PALPATE_LIB_SELECT_MOVES_GLSL

#include "shaders/lib/brush_reach.glsl"
#include "shaders/lib/workgroup_scan.glsl"

shared uint cellStart[kMostSelectCells];  // points in the cells before
shared uint cellFirst[kMostSelectCells];  // first slot

// Whether the brush's ball may reach into a cell; says so, too, where it misses by less than places are rounded.
bool mayReach(HashGrid grid, ivec3 cell) {
  const vec3 center = (ball.center - grid.origin) * grid.inverseCell;
  const float rounding = 0.01 + 1e-6 * max(abs(center.x), max(abs(center.y), abs(center.z)));
  const vec3 gap = max(vec3(0.0), max(vec3(cell) - center, center - vec3(cell + 1)));
  const float radius = brush.radius * grid.inverseCell * (1.0 + 1e-6) + rounding;
  return dot(gap, gap) < radius * radius;
}

bool reached(uint slot, vec4 position, vec4 normal, out PointMove move) {
  if (!brushedMove(slot, position, normal, move)) return false;
  if (brush.kind == kBrushPaint)
    args.tables.at[0].colors.at[move.id] = painted(brush, ball, position.xyz, colorOf(args.tables, move.id));
  else
    resetReach(move.id);
  return true;
}

void take(UpdateLists update, bool wants, PointMove move) {
  const uint at = nextMove(args.update, wants);
  if (wants) writeMove(update, at, move);
}

void selectFromSlots(UpdateLists update, uint i) {
  const uint slot = args.firstSlot + i;
  PointMove move;
  const bool wants =
      i < args.slots && reached(slot, args.cloud.positions.at[slot], args.cloud.normals.at[slot], move);
  take(update, wants, move);
}

// Workgroup `group` of `groups` takes every `groups`-th cell of the brush's box: a surface that lies along the box is
// shared by all of them.
void selectFromCells(UpdateLists update, uint group, uint groups) {
  const uint side = args.cells, lane = scanIndex();
  const ivec3 low = cellOf(args.cloud.grid, ball.center - brush.radius);
  const uint c = group + lane * groups;
  uvec2 range = uvec2(0);
  if (lane < kMostSelectCells && c < side * side * side) {
    const ivec3 cell = low + ivec3(c % side, c / side % side, c / (side * side));
    if (mayReach(args.cloud.grid, cell)) range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cell)];
  }
  uint total;
  const uint start = workgroupExclusiveScan(range.y - range.x, total);
  if (lane < kMostSelectCells) {
    cellStart[lane] = start;
    cellFirst[lane] = range.x;
  }
  barrier();
  for (uint base = 0; base < total; base += gl_WorkGroupSize.x) {
    const uint k = base + lane;
    bool wants = false;
    PointMove move;
    if (k < total) {
      uint owner = 0;
      for (uint step = kMostSelectCells / 2; step > 0; step /= 2)
        if (cellStart[owner + step] <= k) owner += step;
      const uint slot = cellFirst[owner] + k - cellStart[owner];
      const vec4 position = args.cloud.positions.at[slot];
      const vec4 normal = args.cloud.normals.at[slot];  // of all of them: to ask for it later would be to wait twice
      // Another cell of the box may share the bucket: its points are taken when it is that cell's turn.
      const uvec3 inBox = uvec3(cellOf(args.cloud.grid, position.xyz) - low);
      if (all(lessThan(inBox, uvec3(side))) && inBox.x + side * (inBox.y + side * inBox.z) == group + owner * groups)
        wants = reached(slot, position, normal, move);
    }
    take(update, wants, move);
  }
}

#endif
