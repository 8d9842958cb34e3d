// Walk of one subgroup through the points of the cells around a position: each invocation looks up one cell, and then
// all share the points of those cells evenly. The including file defines kWalkNormals, and walkedInBucket(): of a
// bucket with more points than this only the first are visited.
#ifndef PALPATE_LIB_NEIGHBOUR_WALK_GLSL
#define PALPATE_LIB_NEIGHBOUR_WALK_GLSL

#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "shaders/lib/subgroup_reduce.glsl"
#include "shaders/shared/spatial_hash.h"

// Cost of one round of the walk, in units of its budget: one point for each invocation of the subgroup.
const uint kNeighbourRoundWork = 4;
const uint kWalkUnlimited = 0xffffffffu;
// The budget for this many points, or as many empty cells.
uint walkBudget(uint points) { return kNeighbourRoundWork * points / gl_SubgroupSize; }
// Points of the last step: slot; xyz and bits of the id; whether it is in the visited cells, and a neighbour.
uint walkedSlots[kWalkedAtOnce];
vec4 walkedPositions[kWalkedAtOnce];
bool walkedInBox[kWalkedAtOnce], walkedNear[kWalkedAtOnce];
vec3 walkedNormals[kWalkedAtOnce];  // if the including file sets kWalkNormals

ivec3 walkLow;
uvec3 walkSize;
uint walkCells;     // total
uint walkNextCell;  // those before it have been looked up
uint walkWork;
bool walkIsCut;  // a bucket that this invocation looked up has more points than walkedInBucket()
// Of the cells that were looked up last: points before this invocation's cell; its first slot minus that; points in all
// of them; points visited.
uint walkStart, walkSlotAtZero, walkTotal, walkTaken;

// The last invocation whose `start` is at most k; unrolled, since a loop would count against the work that one software
// driver allows an invocation.
uint ownerOf(uint start, uint k) {
  uint owner = 0;
  if (gl_SubgroupSize > 64 && subgroupShuffle(start, owner + 64) <= k) owner += 64;
  if (gl_SubgroupSize > 32 && subgroupShuffle(start, owner + 32) <= k) owner += 32;
  if (gl_SubgroupSize > 16 && subgroupShuffle(start, owner + 16) <= k) owner += 16;
  if (gl_SubgroupSize > 8 && subgroupShuffle(start, owner + 8) <= k) owner += 8;
  if (gl_SubgroupSize > 4 && subgroupShuffle(start, owner + 4) <= k) owner += 4;
  if (gl_SubgroupSize > 2 && subgroupShuffle(start, owner + 2) <= k) owner += 2;
  if (subgroupShuffle(start, owner + 1) <= k) owner += 1;
  return owner;
}

// Over the cells from `low` to `high`.
void beginWalkOver(ivec3 low, ivec3 high) {
  walkLow = low;
  walkSize = uvec3(high - low + 1);
  walkCells = walkSize.x * walkSize.y * walkSize.z;
  walkNextCell = 0;
  walkWork = 0;
  walkIsCut = false;
  walkTotal = 0;
  walkTaken = 0;
}

void beginWalk(vec3 center, float radius) {
  beginWalkOver(cellOf(args.cloud.grid, center - radius), cellOf(args.cloud.grid, center + radius));
}

void lookUpCells() {
  const uint c = walkNextCell + gl_SubgroupInvocationID;
  const uint row = c / walkSize.x, layer = row / walkSize.y;
  const ivec3 cell = walkLow + ivec3(c - row * walkSize.x, row - layer * walkSize.y, layer);
  uvec2 range = uvec2(0);
  if (c < walkCells) range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cell)];
  const uint count = min(range.y - range.x, walkedInBucket());
  walkIsCut = walkIsCut || count < range.y - range.x;
  walkStart = subgroupScan(count, walkTotal);
  walkSlotAtZero = range.x - walkStart;
  walkTaken = 0;
  walkNextCell += gl_SubgroupSize;
  walkWork += kNeighbourRoundWork;
}

// Whether the walk ended with the last cell, not with the budget.
bool walkedAll() { return walkTaken >= walkTotal && walkNextCell >= walkCells; }

// Advances to the next points; false at the end of the walk, or of the budget. The whole subgroup calls it together.
bool walkOn(vec3 center, float radius, uint budget) {
  while (walkTaken >= walkTotal && walkNextCell < walkCells && walkWork < budget) lookUpCells();
  if (walkTaken >= walkTotal || walkWork >= budget) return false;
  uint owners[kWalkedAtOnce];
  [[unroll]] for (uint i = 0; i < kWalkedAtOnce; ++i) {
    const uint k = walkTaken + i * gl_SubgroupSize + gl_SubgroupInvocationID;
    owners[i] = ownerOf(walkStart, k);
    walkedSlots[i] = subgroupShuffle(walkSlotAtZero, owners[i]) + k;
    walkedInBox[i] = k < walkTotal;
  }
  [[unroll]] for (uint i = 0; i < kWalkedAtOnce; ++i)
    walkedPositions[i] = args.cloud.positions.at[walkedInBox[i] ? walkedSlots[i] : 0];
  if (kWalkNormals)
    [[unroll]] for (uint i = 0; i < kWalkedAtOnce; ++i)
      walkedNormals[i] = args.cloud.normals.at[walkedInBox[i] ? walkedSlots[i] : 0].xyz;
  [[unroll]] for (uint i = 0; i < kWalkedAtOnce; ++i) {
    const vec3 d = walkedPositions[i].xyz - center;
    // Another of these cells may share the bucket: its points are visited with that cell.
    const uvec3 inBox = uvec3(cellOf(args.cloud.grid, walkedPositions[i].xyz) - walkLow);
    const uint c = inBox.x + walkSize.x * (inBox.y + walkSize.y * inBox.z);
    walkedInBox[i] = walkedInBox[i] && c + gl_SubgroupSize == walkNextCell + owners[i];
    walkedNear[i] = walkedInBox[i] && dot(d, d) < radius * radius;
  }
  walkTaken += kWalkedAtOnce * gl_SubgroupSize;
  walkWork += kWalkedAtOnce * kNeighbourRoundWork;
  return true;
}

#endif
