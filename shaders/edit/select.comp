#version 460
#extension GL_GOOGLE_include_directive : require
// Which points a brush reaches, and where it brings them: nothing is moved yet. Looks through the cells of the tool's
// box, or through all slots where those are fewer.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"
#include "shaders/lib/workgroup_scan.glsl"

layout(push_constant, scalar) uniform Push { SelectArgs args; };

shared uint cellStart[kSelectCells];  // points in the cells before
shared uint cellFirst[kSelectCells];  // first slot

Brush brush;
Tool tool;

ivec3 lowestCell() { return cellOf(args.cloud.grid, tool.center - brush.toolRadius); }
ivec3 cellOfBox(uint c) {
  return lowestCell() + ivec3(c % args.cells, c / args.cells % args.cells, c / (args.cells * args.cells));
}

// What becomes of the point in a slot; false when nothing does.
bool brushedMove(uint slot, vec4 position, out PointMove move) {
  const uint id = floatBitsToUint(position.w);
  const vec3 away = position.xyz - tool.center;
  if (id == kEmptySlot || dot(away, away) >= brush.toolRadius * brush.toolRadius) return false;
  const vec3 normal = args.cloud.normals.at[slot].xyz;
  const uint bucket = bucketOf(args.cloud.grid, cellOf(args.cloud.grid, position.xyz));
  move = PointMove(position.xyz, id, normal, kMarkRefit, slot, bucket, bucket);
  if (brush.kind == kBrushSmooth) return brushShare(brush, tool, position.xyz) > 0.0;
  if (brush.kind == kBrushPaint) {
    if (isNull(args.colors)) return false;
    const uint before = args.colors.at[id];
    const uint after = painted(brush, tool, position.xyz, before);
    args.colors.at[id] = after;
    move.mark = kMarkGiven;
    return after != before;
  }
  const Brushed result = brushed(brush, tool, position.xyz, normal);
  if (result.taken != 0) {
    move.toBucket = kNoBucket;
    return true;
  }
  move.position = result.position;
  move.toBucket = bucketOf(args.cloud.grid, cellOf(args.cloud.grid, result.position));
  return result.position != position.xyz;
}

void take(bool wants, PointMove move) {
  const uint at = nextMove(args.update, wants);
  if (wants) writeMove(args.update, args.moves, args.marks, args.touched, args.mostMoves, at, move);
}

void selectFromSlots() {
  const uint i = threadIndex();
  const uint slot = args.firstSlot + i;
  PointMove move;
  const bool wants = i < args.slots && brushedMove(slot, args.cloud.positions.at[slot], move);
  take(wants, move);
}

void selectFromCells() {
  const uint cells = args.cells * args.cells * args.cells;
  const uint first = workgroupIndex() * kSelectCells;
  const uint lane = scanIndex();
  uvec2 range = uvec2(0);
  if (lane < kSelectCells && first + lane < cells)
    range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cellOfBox(first + lane))];
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
      if (cellOf(args.cloud.grid, position.xyz) == cellOfBox(first + cell)) wants = brushedMove(slot, position, move);
    }
    take(wants, move);
  }
}

void main() {
  brush = args.brush.at[0];
  const vec3 hip = args.state.at[0].lastHip;
  tool = toolOf(brush, hip, hip - args.state.at[0].motion, args.state.at[0].spring, args.state.at[0].touching);
  if (tool.acts == 0) return;
  if (args.cells == 0)
    selectFromSlots();
  else
    selectFromCells();
}
