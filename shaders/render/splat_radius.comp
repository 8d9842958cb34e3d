#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
// The radius of each point's disc (defined in shaders/shared/splat_radius.h). One subgroup for each point: in hash
// order those of a workgroup visit the same cells. In double precision: tests/render/splat_radius_reference.cpp.
// The result depends on the points in the cells around this one alone, in the order of their ids, and not on what else
// is in their buckets: an edit changes only discs near it.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/shared/frame.h"
#include "shaders/shared/splat_radius.h"

layout(push_constant, scalar) uniform Push { SplatRadiusArgs args; };
const bool kWalkNormals = true;
uint walkedInBucket() { return splatMostInBucket(gl_SubgroupSize); }
#include "shaders/lib/neighbour_walk.glsl"

// cos and sin of 0, 30, ... 150 degrees; the other six directions are their opposites.
const vec3 kCosA = vec3(1, 0.866025404, 0.5), kSinA = vec3(0, 0.5, 0.866025404);
const vec3 kCosB = vec3(0, -0.5, -0.866025404), kSinB = vec3(1, 0.866025404, 0.5);

vec3 selfNormal, axisU, axisV;
bool hasPlane;
float seen;  // radius of the last search
uint visits;  // points visited so far
// One over the distance to the nearest border, in each direction; 0 if there is none.
vec3 aheadA, aheadB, behindA, behindB;
uint neighbours;
uint onSheet, offPlane;  // neighbours in the same sheet, and those of them that are off the plane
bool besideEdge;  // a point of another side was visited
bool clips;       // purpose of the visits
float clipCloseness;
vec2 clipDirection;
uint clipId;

bool ofOtherSide(vec3 other) {
  const float cosine = dot(other, selfNormal);
  return cosine > kSplatSharpest && cosine < kSplatSharp;
}

// Where the plane of a point on the other side intersects that of this disc, unless the edge is concave. The plane of
// an undercut side passes behind this point, which then keeps half of the way to the other one.
void meetOtherSide(uint id, vec3 d, vec3 other) {
  const float above = dot(other, d);
  if (!ofOtherSide(other) || above <= 0 && above <= dot(selfNormal, d)) return;
  const vec2 across = vec2(dot(other, axisU), dot(other, axisV));
  const vec2 direction = normalize(across);
  const float ownCell = 0.5 * (above > 0 ? dot(vec2(dot(d, axisU), dot(d, axisV)), direction) : length(d));
  const float closeness = 1 / max(above / length(across), ownCell);
  if (closeness < clipCloseness || closeness == clipCloseness && id > clipId) return;
  clipCloseness = closeness;
  clipDirection = direction;
  clipId = id;
}

vec3 countedFrom(float least, vec3 closeness) {
  return mix(vec3(0), closeness, greaterThanEqual(closeness, vec3(least)));
}

void visitNeighbour(uint id, vec3 other, vec3 d) {
  const float squared = dot(d, d);
  if (clips) {
    if (squared > 0) meetOtherSide(id, d, other);
    return;
  }
  if (squared == 0 || squared < seen * seen) return;
  if (!hasPlane) {
    ++neighbours;
    return;
  }
  besideEdge = besideEdge || ofOtherSide(other) && dot(other, other) > 0.25;
  if (dot(other, other) > 0.25 && dot(other, selfNormal) <= kSplatSameSheet) return;
  const float above = dot(d, selfNormal);
  ++onSheet;
  offPlane += above * above > kSplatOffPlane * kSplatOffPlane * squared ? 1 : 0;
  const float a = dot(d, axisU) * 2 / squared, b = dot(d, axisV) * 2 / squared;
  const float least = 2 * kSplatAhead / sqrt(squared);
  const vec3 first = a * kCosA + b * kSinA, second = a * kCosB + b * kSinB;
  aheadA = max(aheadA, countedFrom(least, first));
  behindA = max(behindA, countedFrom(least, -first));
  aheadB = max(aheadB, countedFrom(least, second));
  behindB = max(behindB, countedFrom(least, -second));
}

uint visitsOfCells() { return kSplatVisitsOfCell * min(walkNextCell, walkCells); }

// Visits all points nearer than `radius`, each once, of all points in the cells around or, with those cells, the first
// `most` of them, in the order of the cells and of the ids. Returns their number. The whole subgroup calls it together.
uint visitNeighbours(vec3 center, float radius, uint most) {
  uint points = 0;
  beginWalk(center, radius);
  while (points + visitsOfCells() < most && walkOn(center, radius, kWalkUnlimited)) {
    const uint cells = visitsOfCells();
    [[unroll]] for (uint i = 0; i < kWalkedAtOnce; ++i) {
      const uvec4 inBox = subgroupBallot(walkedInBox[i]);
      if (walkedNear[i] && cells + points + subgroupBallotExclusiveBitCount(inBox) < most)
        visitNeighbour(floatBitsToUint(walkedPositions[i].w), walkedNormals[i], walkedPositions[i].xyz - center);
      points += subgroupBallotBitCount(inBox);
    }
  }
  return min(points + visitsOfCells(), most);
}

// Visits the points nearer than `radius` that the last search has not visited. The whole subgroup calls it together.
void search(vec3 center, float radius) {
  neighbours = 0;
  visits += visitNeighbours(center, radius, splatMostVisits(gl_SubgroupSize) - visits);
  aheadA = reduceMax(aheadA);
  aheadB = reduceMax(aheadB);
  behindA = reduceMax(behindA);
  behindB = reduceMax(behindB);
}

// The nearest line along which the disc is clipped, in the tangent plane and in radii: for a position beyond it the dot
// product with this exceeds 1. Zero if there is none.
vec2 clipLine(vec3 center, float radius) {
  clips = true;
  clipCloseness = 0;
  clipDirection = vec2(0);
  clipId = kEmptySlot;
  visitNeighbours(center, kSplatEdgeReach * radius, splatMostEdgeVisits(gl_SubgroupSize));
  const float nearest = reduceMax(clipCloseness);
  if (nearest * radius <= 1) return vec2(0);
  const bool isNearest = clipCloseness == nearest;
  const uint id = reduceMin(isNearest ? clipId : kEmptySlot);
  const uint owner = reduceMin(isNearest && clipId == id ? gl_SubgroupInvocationID : gl_SubgroupSize);
  return nearest * radius * vec2(subgroupShuffle(clipDirection.x, owner), subgroupShuffle(clipDirection.y, owner));
}

float leastOf(vec3 v) { return min(min(v.x, v.y), v.z); }
float mostOf(vec3 v) { return max(max(v.x, v.y), v.z); }

// Of all directions, the closeness of rank kSplatUsualRank.
float usualCloseness() {
  vec3 all[4] = vec3[4](aheadA, aheadB, behindA, behindB);
  float usual = 0;
  for (uint rank = 0; rank < kSplatUsualRank; ++rank) {
    usual = max(max(mostOf(all[0]), mostOf(all[1])), max(mostOf(all[2]), mostOf(all[3])));
    bool taken = false;  // one at a time if several are equal
    for (uint k = 0; k < 12; ++k)
      if (!taken && all[k / 3][k % 3] == usual) {
        all[k / 3][k % 3] = -1;
        taken = true;
      }
  }
  return usual;
}

// The smallest closeness that is not open; `none` if all are open.
float leastClosed(vec3 closeness, float open, float none) {
  return leastOf(mix(vec3(none), closeness, greaterThanEqual(closeness, vec3(open))));
}

float leastCloseness() {
  return min(min(leastOf(aheadA), leastOf(aheadB)), min(leastOf(behindA), leastOf(behindB)));
}

// Of a point without a neighbour near enough to be on the same surface.
float radiusAlone() { return min(args.spacing, args.widest); }

float radiusInPlane(float usual, float open) {
  const float kNone = 3.0e38;
  if (leastCloseness() < open) open = max(open, usual / kSplatOpenAtBorder);
  const float least = min(min(leastClosed(aheadA, open, kNone), leastClosed(aheadB, open, kNone)),
                          min(leastClosed(behindA, open, kNone), leastClosed(behindB, open, kNone)));
  return least < kNone ? kSplatCover / least : radiusAlone();
}

// The whole subgroup calls it together.
bool isOfSurface() {
  const float around = float(reduceAdd(onSheet));
  return around >= float(kSplatFewestAround) && float(reduceAdd(offPlane)) <= kSplatOff * around;
}

void main() {
  const uint splat = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID;
  if (splat >= args.count) return;
  const uint slot = args.onlyListed != 0 ? args.list.at[splat] : splat;
  const vec4 point = args.cloud.positions.at[slot];
  const uint id = floatBitsToUint(point.w);
  if (id == kEmptySlot) return;

  selfNormal = args.cloud.normals.at[slot].xyz;
  hasPlane = dot(selfNormal, selfNormal) > 0.25;
  frameAround(hasPlane ? selfNormal : vec3(0, 0, 1), axisU, axisV);
  aheadA = aheadB = behindA = behindB = vec3(0);
  seen = 0;
  visits = 0;
  besideEdge = false;
  clips = false;
  onSheet = offPlane = 0;
  const uvec2 own = args.cloud.ranges.at[bucketOf(args.cloud.grid, cellOf(args.cloud.grid, point.xyz))];
  const float crowd = float(own.y - own.x) / float(kSplatUsualInCell);
  const float farthest = 2 * args.widest;
  float reach = min(kSplatFirstSearch * args.spacing / sqrt(max(crowd, 1)), farthest);
  float radius = radiusAlone();
  uint met = 0;
  while (true) {
    search(point.xyz, reach);
    bool enough;
    if (hasPlane) {
      const float usual = usualCloseness();
      const float open = max(usual / kSplatOpen, 1 / args.widest);
      radius = radiusInPlane(usual, open);
      // Points not visited yet cannot be closer than this in any direction.
      const float unseen = 2 / reach;
      enough = leastCloseness() >= unseen || open >= unseen;
    } else {
      met += reduceAdd(neighbours);
      radius = min(kSplatWithoutPlane * reach * sqrt(3.14159265 / float(met + 1)), 2 * radiusAlone());
      enough = met >= kSplatFewest;
    }
    if (enough || reach >= farthest || visits >= splatMostVisits(gl_SubgroupSize)) break;
    seen = reach;
    reach = min(2 * reach, farthest);
  }
  if (hasPlane && radius > kSplatLone * args.spacing && !isOfSurface()) radius = radiusAlone();
  const vec2 clip = subgroupAny(besideEdge) ? clipLine(point.xyz, radius) : vec2(0);
  if (!subgroupElect()) return;
  args.normals.at[id].w = radius;
  args.clips.at[id] = packHalf2x16(min(abs(clip), vec2(6e4)) * sign(clip));
  const uvec2 sizes = floatBitsToUint(vec2(radius, max(reach, kSplatEdgeReach * radius)));
  args.reaches.at[id] = sizes.y;
  // The plain reads may be stale, but the largest only grow.
  if (sizes.x > args.widths.at[id / kDiscBlock]) atomicMax(args.widths.at[id / kDiscBlock], sizes.x);
  [[unroll]] for (uint k = 0; k < 2; ++k)
    if (sizes[k] > args.largest.at[k]) atomicMax(args.largest.at[k], sizes[k]);
}
