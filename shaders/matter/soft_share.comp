#version 460
#extension GL_GOOGLE_include_directive : require
// Share of each node of a soft body in a press: the press takes the mean of the skin points around it, with the weights
// that touch has for them, reduced for points that face away; each point is the interpolation of its cell's nodes.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_press.h"
#include "shaders/shared/weight.h"

layout(push_constant, scalar) uniform Push { SoftShareArgs args; };

#include "shaders/lib/matter_sums.glsl"
#include "shaders/lib/soft_boxes.glsl"
#include "shaders/lib/soft_cells.glsl"

shared float nearest2[kMatterBlock];
shared uint nearestNumber[kMatterBlock], nearestSlot[kMatterBlock], nearestAt[kMatterBlock];

vec3 placeOf(uint at, Corners moved) {
  const vec3 share = args.skin.at[kSkinVec4s * at].xyz;
  vec3 place = args.skin.at[kSkinVec4s * at + 1].xyz;
  [[unroll]] for (int k = 0; k < 8; ++k) place += cornerShare(share, k) * moved.at[k];
  return place;
}

// The sum of what the skin points in a cell contribute to one of its corners.
float givenTo(uint slot, int corner, vec3 middle, float radius, vec3 normal) {
  const Corners moved = displacementsOf(slot);
  Corners modes = moved;
  takeModes(modes);
  const mat3 change = gradientOf(softRules(), modes);
  float sum = 0;
  for (uint at = args.skinCells.at[slot].first; at < args.skinCells.at[slot + 1].first; ++at) {
    const vec3 offset = placeOf(at, moved) - middle;
    const float away2 = dot(offset, offset);
    if (!(away2 < radius * radius)) continue;
    const float facing = facingWeight(dot(unitNormalCarried(change, args.normals.at[at].xyz), normal));
    const float weight = facing * wendland(sqrt(away2) / radius);
    if (weight > 0) sum += max(weight * cornerShare(args.skin.at[kSkinVec4s * at].xyz, corner), 0);
  }
  return sum;
}

float givenTo(uint node, uint press) {
  const vec3 middle = args.presses.at[press].place, normal = args.presses.at[press].normal;
  const float radius = args.presses.at[press].radius;
  float sum = 0;
  for (uint k = 0; k < 8; ++k) {
    const uint word = args.incident.at[kIncidentUVec4s * node + k / 4][k % 4];
    const uint slot = word % args.stride, corner = word / args.stride / 3;
    if (cellIsInReach(slot, middle, radius)) sum += givenTo(slot, int(corner), middle, radius, normal);
  }
  return sum;
}

// Of the nearest skin points the one with the lowest number; for all invocations of a workgroup.
void findNearest(vec3 middle) {
  const uint local = gl_LocalInvocationIndex;
  float least2 = 3.4e38;
  uint number = ~0u, slotOfLeast = 0, atOfLeast = 0;
  for (uint slot = local; slot < args.skinCount; slot += kMatterBlock) {
    const Corners moved = displacementsOf(slot);
    for (uint at = args.skinCells.at[slot].first; at < args.skinCells.at[slot + 1].first; ++at) {
      const vec3 offset = placeOf(at, moved) - middle;
      const float away2 = dot(offset, offset);
      const uint its = floatBitsToUint(args.normals.at[at].w);
      if (!(away2 < least2 || (away2 == least2 && its < number))) continue;
      least2 = away2;
      number = its;
      slotOfLeast = slot;
      atOfLeast = at;
    }
  }
  nearest2[local] = least2;
  nearestNumber[local] = number;
  nearestSlot[local] = slotOfLeast;
  nearestAt[local] = atOfLeast;
  for (uint left = kMatterBlock / 2; left > 0; left /= 2) {
    barrier();
    if (local >= left) continue;
    const uint other = local + left;
    if (!(nearest2[other] < nearest2[local] ||
          (nearest2[other] == nearest2[local] && nearestNumber[other] < nearestNumber[local])))
      continue;
    nearest2[local] = nearest2[other];
    nearestNumber[local] = nearestNumber[other];
    nearestSlot[local] = nearestSlot[other];
    nearestAt[local] = nearestAt[other];
  }
  barrier();
}

// The corners of a cell are in the order of their nodes.
void holdNearest(uint press, uint row) {
  findNearest(args.presses.at[press].place);
  const uint local = gl_LocalInvocationIndex;
  if (local == 0) args.counts.at[1 + row] = 8;
  if (local >= 8) return;
  const uint at = row * args.heldStride + local;
  args.held.at[at].node = nodeAt(args.corners.at[nearestSlot[0]], local);
  args.held.at[at].share = max(cornerShare(args.skin.at[kSkinVec4s * nearestAt[0]].xyz, int(local)), 0);
}

// Of all shares, and of those of pinned nodes.
vec2 sumsOf(uint row, uint held) {
  vec4 sums = vec4(0), none = vec4(0);
  for (uint k = gl_LocalInvocationIndex; k < held; k += kMatterBlock) {
    const uint at = row * args.heldStride + k;
    const float share = args.held.at[at].share;
    sums.x += share;
    if (args.nodes.at[kNodeVec4s * args.held.at[at].node + 1].w == 0) sums.y += share;
  }
  addUp(sums, none, false);
  return sums.xy;
}

// Shares of the nodes of a press; false if it holds only the nearest skin point.
bool findShares(uint press, uint row) {
  const uint local = gl_LocalInvocationIndex;
  uint held = args.counts.at[1 + row];
  for (uint k = local; k < held; k += kMatterBlock) {
    const uint at = row * args.heldStride + k;
    args.held.at[at].share = givenTo(args.held.at[at].node, press);
  }
  float sum = sumsOf(row, held).x;
  const bool isNear = sum > 0;
  if (!isNear) {
    holdNearest(press, row);
    held = 8;
    sum = sumsOf(row, held).x;
  }
  for (uint k = local; k < held; k += kMatterBlock) args.held.at[row * args.heldStride + k].share /= sum;
  return isNear;
}

void main() {
  const uint press = workgroupIndex();
  if (press >= args.counts.at[0]) return;
  const uint row = args.presses.at[press].row;
  bool isNear = true;
  if (args.presses.at[press].same == 0) isNear = findShares(press, row);
  barrier();
  const vec2 sums = sumsOf(row, args.counts.at[1 + row]);
  if (gl_LocalInvocationIndex != 0) return;
  args.done.at[press].force = args.presses.at[press].force;
  args.done.at[press].work = 0;
  args.done.at[press].impulse = vec3(0);
  args.done.at[press].pinned = sums.y / sums.x;
  args.done.at[press].moved = vec3(0);
  args.done.at[press].alone = isNear ? 0 : 1;
}
