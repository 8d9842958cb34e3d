// Which points a brush reaches, and where it brings them: nothing is moved yet.
#ifndef PALPATE_LIB_SELECT_MOVES_GLSL
#define PALPATE_LIB_SELECT_MOVES_GLSL

#include "shaders/lib/brush_reach.glsl"
#include "shaders/lib/workgroup_scan.glsl"

shared uint cellStart[kSelectCells];  // points in the cells before
shared uint cellFirst[kSelectCells];  // first slot

ivec3 cellOfTool(CollectArgs args, uint c) {
  return cellOf(args.cloud.grid, tool.center - brush.toolRadius) +
         ivec3(c % args.cells, c / args.cells % args.cells, c / (args.cells * args.cells));
}

bool reached(CollectArgs args, uint slot, vec4 position, out PointMove move) {
  if (!brushedMove(args.cloud, args.tables, slot, position, move)) return false;
  if (brush.kind == kBrushPaint)
    args.tables.at[0].colors.at[move.id] = painted(brush, tool, position.xyz, colorOf(args.tables, move.id));
  return true;
}

void take(CollectArgs args, bool wants, PointMove move) {
  const uint at = nextMove(args.update, wants);
  if (wants) writeMove(args.update, args.moves, args.marks, args.touched, args.tables.at[0].mostMoves, at, move);
}

void selectFromSlots(CollectArgs args, uint i) {
  const uint slot = args.firstSlot + i;
  PointMove move;
  const bool wants = i < args.slots && reached(args, slot, args.cloud.positions.at[slot], move);
  take(args, wants, move);
}

// One workgroup takes kSelectCells cells of the tool's box.
void selectFromCells(CollectArgs args, uint first) {
  const uint cells = args.cells * args.cells * args.cells;
  const uint lane = scanIndex();
  uvec2 range = uvec2(0);
  if (lane < kSelectCells && first + lane < cells)
    range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cellOfTool(args, first + lane))];
  uint total;
  const uint start = workgroupExclusiveScan(range.y - range.x, total);
  if (lane < kSelectCells) {
    cellStart[lane] = start;
    cellFirst[lane] = range.x;
  }
  barrier();
  for (uint base = 0; base < total; base += gl_WorkGroupSize.x) {
    const uint k = base + lane;
    bool wants = false;
    PointMove move;
    if (k < total) {
      uint cell = 0;
      for (uint step = kSelectCells / 2; step > 0; step /= 2)
        if (cellStart[cell + step] <= k) cell += step;
      const uint slot = cellFirst[cell] + k - cellStart[cell];
      const vec4 position = args.cloud.positions.at[slot];
      // Another cell of the box may share the bucket: its points are taken when it is that cell's turn.
      if (cellOf(args.cloud.grid, position.xyz) == cellOfTool(args, first + cell))
        wants = reached(args, slot, position, move);
    }
    take(args, wants, move);
  }
}

#endif
