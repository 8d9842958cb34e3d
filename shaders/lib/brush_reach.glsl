// Effect of a brush on one point of the cloud.
#ifndef PALPATE_LIB_BRUSH_REACH_GLSL
#define PALPATE_LIB_BRUSH_REACH_GLSL

#include "shaders/lib/list_moves.glsl"

Brush brush;
BrushTool tool;

void takeUpBrush(Brushes brushes, BrushTools tools) {
  brush = brushes.at[0];
  tool = tools.at[0].tool;
}

// A point as the stroke found it.
FoundPoint foundPoint(uint id, vec3 position, vec3 normal) {
  if (args.tables.at[0].founds.at[id].stroke != tool.stroke)
    return FoundPoint(position, normal, brushHas(brush, kLooksAhead) ? kFirstStep * brush.support : kUnseen,
                      lockOf(args.tables, id));
  return FoundPoint(args.tables.at[0].founds.at[id].position, args.tables.at[0].founds.at[id].normal,
                    args.tables.at[0].founds.at[id].room, lockOf(args.tables, id));
}
void noteFound(uint id, FoundPoint found) {
  if (args.tables.at[0].founds.at[id].stroke == tool.stroke) return;
  // Field by field: the validation layer of Debian 12 overestimates the size of a whole entry. The stroke comes last:
  // a subgroup that recalls the point's request may read the entry meanwhile.
  args.tables.at[0].founds.at[id].position = found.position;
  args.tables.at[0].founds.at[id].normal = found.normal;
  args.tables.at[0].founds.at[id].room = found.room;
  memoryBarrierBuffer();
  args.tables.at[0].founds.at[id].stroke = tool.stroke;
}

PointMove stayingMove(uint slot, vec4 position, vec3 normal) {
  const uint bucket = bucketAt(position.xyz);
  return PointMove(position.xyz, floatBitsToUint(position.w), normal, kMarkRefit, slot, bucket, bucket, 0,
                   kEmptySlot);
}

// The reach of a point that the brush moves is the full one again.
void resetReach(uint id) {
  const uint firstNew = args.tables.at[0].firstNew;
  if (id >= firstNew) args.tables.at[0].reaches.at[id - firstNew] = kReach * brush.support;
}

// Whether the tool may reach a point.
bool isInReach(uint id, vec3 position) {
  const vec3 away = position - tool.middle;
  return tool.acts != 0 && id != kEmptySlot && dot(away, away) < tool.reach * tool.reach;
}

// Whether the brush acts on a point in reach.
bool isActedOn(FoundPoint found) {
  if (brushHas(brush, kRemovesPoints)) return true;
  const uint cell = connectedCell(tool, found);
  return (args.tool.at[0].connected[cell / 32] >> (cell % 32) & 1) != 0;
}

// The same point with any room.
FoundPoint withRoom(FoundPoint found) { return FoundPoint(found.position, found.normal, kUnseen, found.lock); }

// Notes that a point under the brush has no room to move, for its neighbours (request.comp).
void noteBlocked(uint id) {
  ResampleLists lists = args.tables.at[0].lists;
  args.tables.at[0].examined.at[id] = kIsBlocked | lists.now.tick + 1 & kTickBits;
  lists.now.blocked = tool.stroke;
}

// The move of a point in reach; false if the point does not change.
bool brushedMove(uint slot, vec4 position, vec4 normal, FoundPoint found, out PointMove move) {
  const uint id = floatBitsToUint(position.w);
  move = stayingMove(slot, position, normal.xyz);
  if (isLocked(args.tables, id)) return false;
  if (normal.w == kMarkGoes) {
    move.toBucket = kNoBucket;
    return true;
  }
  if (brushHas(brush, kUsesNeighbours))
    return brushShare(brush, tool, position.xyz, found.normal) > 0.0 && isActedOn(found);
  if (brushHas(brush, kPaintsPoints)) {
    const uint color = colorOf(args.tables, id);
    move.mark = kMarkGiven;
    return painted(brush, tool, position.xyz, found, color) != color && isActedOn(found);
  }
  const Brushed result = brushed(brush, tool, position.xyz, normal.xyz, found);
  if (result.taken != 0) {
    // Resampling removes it in the next edit, by its own request: until then the near sheet of a plate sees the far
    // one.
    if (!resamples(args.tables)) move.toBucket = kNoBucket;
    return true;
  }
  move.position = result.position;
  move.toBucket = bucketAt(result.position);
  return result.position != position.xyz && isActedOn(found);
}

#endif
