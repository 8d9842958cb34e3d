#version 460
#extension GL_GOOGLE_include_directive : require
// Lists the points whose discs have to be measured again: those whose search visited a changed cell, and those in a
// changed bucket. One subgroup for each layer of cells around each listed one.
#extension GL_KHR_shader_subgroup_vote : require
#include "shaders/lib/index.glsl"
#include "shaders/render/cell_lists.glsl"
#include "shaders/shared/splat_radius.h"

layout(push_constant, scalar) uniform Push { SplatNearArgs args; };
const bool kWalkNormals = false;
uint walkedInBucket() { return kSplatMostNearInBucket; }
#include "shaders/lib/neighbour_walk.glsl"
#include "shaders/render/disc_list.glsl"

// The whole subgroup calls it together; each point is listed once.
void listOnce(bool wants, uint slot, uint id) {
  if (wants) wants = (atomicOr(args.reaches.at[id], kSplatListed) & kSplatListed) == 0;
  listDisc(wants, slot);
}

bool hasVisited(vec3 center, uint id, ivec3 cell) {
  const float reach = uintBitsToFloat(args.reaches.at[id] & ~kSplatListed);
  return all(lessThanEqual(cellOf(args.cloud.grid, center - reach), cell)) &&
         all(lessThanEqual(cell, cellOf(args.cloud.grid, center + reach)));
}

void listBucket(uvec2 range) {
  for (uint base = range.x; base < range.y; base += gl_SubgroupSize) {
    const uint slot = base + gl_SubgroupInvocationID;
    const bool isThere = slot < range.y;
    listOnce(isThere, slot, floatBitsToUint(args.cloud.positions.at[isThere ? slot : base].w));
  }
}

// The distance, in cells, within which a point may have visited a cell; positions are rounded.
int cellsInReach() {
  const float reach = uintBitsToFloat(args.largest.at[1]) * args.cloud.grid.inverseCell;
  return min(int(floor(1.001 * reach + 0.02)) + 1, int(kSplatNearLayers / 2));
}

void main() {
  const uint item = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID;
  const uint i = item / kSplatNearLayers, layer = item % kSplatNearLayers;
  if (i >= args.listed) return;
  const ivec3 cell = args.cells.at[i];
  const uint bucket = bucketOf(args.cloud.grid, cell);
  const uint last = args.lastOf.at[bucket] - args.listedBefore - 1;
  if (last != i && args.cells.at[last] == cell) return;  // it is listed again
  const uvec2 own = args.cloud.ranges.at[bucket];
  if (own.y - own.x > splatMostInBucket(gl_SubgroupSize)) {
    if (subgroupElect()) args.cells.about.everywhere = 1;
    return;
  }
  if (layer == 0) listBucket(own);
  const int about = cellsInReach(), z = cell.z - about + int(layer);
  if (z > cell.z + about) return;
  const float kAnyDistance = 1e18;
  beginWalkOver(ivec3(cell.xy - about, z), ivec3(cell.xy + about, z));
  while (walkOn(vec3(0), kAnyDistance, kWalkUnlimited)) {
    [[unroll]] for (uint k = 0; k < kWalkedAtOnce; ++k) {
      const uint id = floatBitsToUint(walkedPositions[k].w);
      bool visited = walkedNear[k];
      if (visited) visited = hasVisited(walkedPositions[k].xyz, id, cell);
      listOnce(visited, walkedSlots[k], id);
    }
  }
  if (subgroupAny(walkIsCut) && subgroupElect()) args.cells.about.everywhere = 1;
}
