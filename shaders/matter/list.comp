#version 460
#extension GL_GOOGLE_include_directive : require
// Lists the neighbours of each particle, in the order of the cells around it. Copies the sorted particles back to the
// arrays that the other passes read: each invocation moves its own slot, and reads others only in the sorted copy.
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterListArgs args; };

#include "shaders/lib/matter_lists.glsl"
#include "shaders/lib/matter_setting.glsl"

uint slot, count;
uvec4 four;  // the last neighbours, until there are four
vec3 seenFrom;

// False if the list is full.
bool listRun(uint begin, uint end, uint image) {
  const float reach2 = SETTING.listed * SETTING.listed;
  const uint most = SETTING.mostListed;
  for (uint other = begin; other < end; ++other) {
    const vec3 offset = seenFrom - args.sortedPlaces.at[other].xyz;
    if (!(dot(offset, offset) < reach2) || other == slot) continue;
    if (count == most) return false;
    const uint part = count % kListedAtOnce, neighbour = listed(other, image);
    four = uvec4(part == 0 ? neighbour : four.x, part == 1 ? neighbour : four.y, part == 2 ? neighbour : four.z,
                 part == 3 ? neighbour : four.w);
    if (part + 1 == kListedAtOnce) args.lists.at[count / kListedAtOnce * args.stride + slot] = four;
    ++count;
  }
  return true;
}

bool listAll(vec3 place) {
  const MatterCells cells = particleCells();
  const ivec3 cell = cellOf(cells, place);
  const bool openX = isPeriodic(cells, 0);
  for (int row = 0; row < kRowsAbout; ++row) {
    const CellAlong y = cellAlong(cell.y + row % kRowsWide - kCellsBeside, cells.cells.y, isPeriodic(cells, 1));
    const CellAlong z = cellAlong(cell.z + row / kRowsWide - kCellsBeside, cells.cells.z, isPeriodic(cells, 2));
    if (y.image == kNoImage || z.image == kNoImage) continue;
    const uint first = numberOf(cells, ivec3(0, y.cell, z.cell));
    for (uint x = openX ? 0 : 1; x < (openX ? 3 : 2); ++x) {
      const CellRun run = runAlong(cell.x, cells.cells.x, openX, x);
      if (run.begin >= run.end) continue;
      const uint image = x + 3 * y.image + 9 * z.image;
      seenFrom = place - shiftOf(cells, image);
      if (!listRun(args.firsts.at[first + run.begin], args.firsts.at[first + run.end], image)) return false;
    }
  }
  return true;
}

void main() {
  slot = threadIndex();
  if (slot >= args.particles || !needsLists() || args.control.now.crowdedCell != 0) return;
  const vec4 place = args.sortedPlaces.at[slot];
  args.places.at[slot] = place;
  args.positions.at[slot] = args.sortedPositions.at[slot];
  args.velocities.at[args.control.now.parity * args.particles + slot] = args.sortedVelocities.at[slot];
  args.ids.at[slot] = args.sortedIds.at[slot];
  count = 0;
  four = uvec4(0);
  if (!listAll(place.xyz)) atomicOr(args.control.now.crowdedList, 1);
  if (count % kListedAtOnce != 0) args.lists.at[count / kListedAtOnce * args.stride + slot] = four;
  args.listLengths.at[slot] = count;
}
