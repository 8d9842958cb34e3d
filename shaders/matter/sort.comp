#version 460
#extension GL_GOOGLE_include_directive : require
// Sorts particles by their cells, stably within a cell: a particle's rank is the number of particles of its cell before
// it.
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterSortArgs args; };

#include "shaders/lib/matter_setting.glsl"

void main() {
  const uint at = threadIndex();
  if (at >= args.particles || !needsLists()) return;
  const uint from = args.order.at[at], cell = args.cells.at[from];
  const uint begin = args.firsts.at[cell], end = args.firsts.at[cell + 1];
  if (end - begin > kMaxInCell) {
    atomicOr(args.control.now.crowdedCell, 1);
    return;
  }
  uint to = begin;
  for (uint other = begin; other < end; ++other) to += args.order.at[other] < from ? 1 : 0;
  args.sortedPlaces.at[to] = args.places.at[from];
  args.sortedPositions.at[to] = args.positions.at[from];
  args.sortedVelocities.at[to] = args.velocities.at[args.control.now.parity * args.particles + from];
  args.sortedIds.at[to] = args.ids.at[from];
}
