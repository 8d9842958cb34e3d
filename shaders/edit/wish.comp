#version 460
#extension GL_GOOGLE_include_directive : require
// The surface stays a surface: every point that was looked at in this tick finds out whether it crowds another one and
// goes, or whether there is a gap beside it that a new point should fill. One subgroup for each point. In double
// precision, with the reasons: engine/edit/resample_reference.cpp. A wish is heard in the next tick.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"
#include "shaders/lib/neighbours.glsl"

layout(push_constant, scalar) uniform Push { WishArgs args; };

// A point as others see it; offset from the point that decides.
struct Seen {
  vec3 offset;
  vec3 normal;
  float spacing;
  uint rank;  // who stays when two crowd: the smaller one
};

const uint kNobody = 0xffffffffu;
const float kFar = 3.0e38;
const uint kLookAround = 0, kLookYields = 1, kLookBlocks = 2;

uint look;  // what the visits are for
Seen self;
uint selfSlot;
uint tick;
// Of this invocation's visits.
uint firstRank, firstSlot;  // of those that crowd the point
Seen first;
bool firstYields;
vec3 axisU, axisV;
float sectorDistance[kSectors];
uint sectorId[kSectors], sectorSlot[kSectors];
vec3 gapPlace[kSectors];
bool gapOpen[kSectors], gapBlocked[kSectors];

Seen seen(uint slot, uint id, vec3 d) {
  // Those looked at in this tick come after all others.
  const uint unsettled = args.tables.at[0].looks.at[id] == tick ? 0x80000000u : 0u;
  return Seen(d, args.cloud.normals.at[slot].xyz, spacingOf(args.tables, id), unsettled | id);
}
bool sameSheet(vec3 a, vec3 b) { return dot(a, b) > kSameSheet; }
bool hasToYield(Seen point, Seen other) {
  const vec3 d = point.offset - other.offset;
  const float closest = kCrowded * min(point.spacing, other.spacing);
  return other.rank < point.rank && dot(d, d) < closest * closest && sameSheet(point.normal, other.normal);
}

// Only who is nearer than the point's own spacing allows may crowd it.
void noteCrowding(uint slot, uint id, vec3 d) {
  const float closest = kCrowded * self.spacing;
  if (dot(d, d) >= closest * closest) return;
  const Seen other = seen(slot, id, d);
  if (!hasToYield(self, other) || other.rank >= firstRank) return;
  firstRank = other.rank;
  firstSlot = slot;
}

void noteSector(uint slot, uint id, vec3 d) {
  const uint sector = sectorOf(dot(d, axisU), dot(d, axisV));
  const float size = length(d);
  if (size > sectorDistance[sector] || (size == sectorDistance[sector] && id > sectorId[sector])) return;
  sectorDistance[sector] = size;
  sectorId[sector] = id;
  sectorSlot[sector] = slot;
}

void visitNeighbour(uint slot, vec4 position, vec3 d) {
  if (slot == selfSlot) return;
  const uint id = floatBitsToUint(position.w);
  if (look == kLookYields) {
    firstYields = firstYields || hasToYield(first, seen(slot, id, d));
    return;
  }
  const vec3 normal = args.cloud.normals.at[slot].xyz;
  if (!sameSheet(self.normal, normal)) return;
  if (look == kLookAround) {
    noteSector(slot, id, d);
    noteCrowding(slot, id, d);
    return;
  }
  const float clearance = kLeastClearance * self.spacing;
  for (uint s = 0; s < kSectors; ++s) {
    const vec3 to = d - gapPlace[s];
    gapBlocked[s] = gapBlocked[s] || dot(to, to) < clearance * clearance;
  }
}

void visitAll(uint what, vec3 center) {
  look = what;
  visitNeighbours(args.cloud, center, args.radius, kWishWorkBudget);
}

// A frame about a unit vector (Duff et al. 2017).
void frameAround(vec3 n) {
  const float sign = n.z < 0.0 ? -1.0 : 1.0;
  const float a = -1.0 / (sign + n.z);
  const float b = n.x * n.y * a;
  axisU = vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
  axisV = vec3(b, sign + n.y * n.y * a, -n.y);
}

void lookAround(vec3 center) {
  frameAround(self.normal);
  firstRank = kNobody;
  firstSlot = kNobody;
  for (uint s = 0; s < kSectors; ++s) {
    sectorDistance[s] = kFar;
    sectorId[s] = kNobody;
    sectorSlot[s] = kNobody;
  }
  visitAll(kLookAround, center);
}

// The point is crowded by one before it that stays itself; `crowded`: by one at least.
bool goes(vec3 center, out bool crowded) {
  const uint least = subgroupMin(firstRank);
  crowded = least != kNobody;
  if (!crowded) return false;
  const uint slot = subgroupMin(firstRank == least ? firstSlot : kNobody);
  const vec4 position = args.cloud.positions.at[slot];
  first = seen(slot, floatBitsToUint(position.w), position.xyz - center);
  firstYields = false;
  visitAll(kLookYields, center);
  return !subgroupAny(firstYields);
}

// The sector with the narrowest gap that no point fills yet; kSectors where there is none.
uint openGap(vec3 center) {
  bool any = false;
  for (uint s = 0; s < kSectors; ++s) {
    const float nearest = subgroupMin(sectorDistance[s]);
    const uint id = subgroupMin(sectorDistance[s] == nearest ? sectorId[s] : kNobody);
    const uint slot = subgroupMin(sectorDistance[s] == nearest && sectorId[s] == id ? sectorSlot[s] : kNobody);
    sectorDistance[s] = nearest;
    sectorSlot[s] = slot;
    gapOpen[s] = nearest < kFar && nearest > kWidestGap * self.spacing;
    gapPlace[s] = vec3(kFar);
    if (gapOpen[s]) {
      const vec3 offset = args.cloud.positions.at[slot].xyz - center;
      gapPlace[s] = halfWay(offset, self.normal, args.cloud.normals.at[slot].xyz);
      const float clearance = kLeastClearance * self.spacing;
      gapOpen[s] = dot(gapPlace[s], gapPlace[s]) >= clearance * clearance;
    }
    gapBlocked[s] = false;
    any = any || gapOpen[s];
  }
  if (!any) return kSectors;
  visitAll(kLookBlocks, center);
  uint best = kSectors;
  for (uint s = 0; s < kSectors; ++s) {
    const bool blocked = subgroupAny(gapBlocked[s]);
    if (gapOpen[s] && !blocked && (best == kSectors || sectorDistance[s] < sectorDistance[best])) best = s;
  }
  return best;
}

uint middleColor(uint a, uint b) {
  if (a == b) return a;
  if (a == 0) a = kUnpainted;
  if (b == 0) b = kUnpainted;
  uint middle = 0;
  for (uint bit = 0; bit < 32; bit += 8)
    middle |= ((((a >> bit) & 255u) + ((b >> bit) & 255u) + 1) / 2) << bit;
  return middle;
}

// One invocation writes it.
void wishFor(uint id, vec3 center, uint sector) {
  const uint at = atomicAdd(args.lists.now.wishes, 1);
  if (at >= args.most) return;
  atomicMax(args.lists.now.wishGroups.x, updateGroups(at + 1, gl_NumSubgroups));
  args.lists.wishes[at].position = center;
  args.lists.wishes[at].id = id;
  const bool inserts = sector < kSectors;
  args.lists.wishes[at].inserts = inserts ? 1 : 0;
  if (!inserts) return;
  const vec3 place = center + gapPlace[sector];
  const vec4 other = args.cloud.positions.at[sectorSlot[sector]];
  const vec3 sum = self.normal + args.cloud.normals.at[sectorSlot[sector]].xyz;
  const float size = length(sum);
  args.lists.wishes[at].place = place;
  args.lists.wishes[at].normal = size > 1e-3 ? sum / size : self.normal;
  args.lists.wishes[at].color = middleColor(colorOf(args.tables, id), colorOf(args.tables, floatBitsToUint(other.w)));
  args.lists.wishes[at].parent = parentOf(args.tables, id);
  const HashGrid grid = claimGrid(args.radius / kSupportSpacings);
  atomicMin(args.lists.claims[bucketOf(grid, cellOf(grid, place))], id);
}

void main() {
  if (args.update.at[0].failed != 0) return;
  tick = args.lists.now.tick;
  const uint changed = args.update.at[0].changed;
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint which = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; which < changed; which += stride) {
    selfSlot = args.changed.at[which];
    const vec4 position = args.cloud.positions.at[selfSlot];
    const uint id = floatBitsToUint(position.w);
    if (args.tables.at[0].looks.at[id] == tick) {
      self = seen(selfSlot, id, vec3(0.0));
      lookAround(position.xyz);
      bool crowded;
      const bool leaves = goes(position.xyz, crowded);
      const uint gap = leaves ? kSectors : openGap(position.xyz);
      if (subgroupElect() && (leaves || crowded || gap < kSectors)) {
        if (leaves) args.cloud.normals.at[selfSlot].w = kMarkGoes;
        wishFor(id, position.xyz, gap);
      }
    }
  }
}
