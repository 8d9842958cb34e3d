#version 460
#extension GL_GOOGLE_include_directive : require
// Every point examined in this tick looks at what lies ahead of it, and keeps the surface evenly sampled: it determines
// whether it crowds another one and is to be removed, or whether there is a gap beside it that a new point should fill.
// Without resampling it only looks ahead. One subgroup for each point. In double precision, with the reasons:
// engine/edit/cpu_requests.cpp and resampling.cpp. Nothing else in this tick waits for it: requests are carried out in
// the next one.
#include "shaders/lib/index.glsl"
#include "shaders/lib/claims.glsl"
#include "shaders/lib/edit_end.glsl"
#include "shaders/lib/subgroup_sum.glsl"
#include "shaders/shared/carried_normal.h"
#include "shaders/shared/frame.h"
#include "shaders/shared/look_ahead.h"

layout(push_constant, scalar) uniform Push { RequestArgs args; };
#include "shaders/lib/kept_neighbours.glsl"

// A point as other points see it; offset from the point that decides.
struct Seen {
  vec3 offset;
  vec3 normal;
  vec3 rest;  // its position as loaded
  float spacing;
  uint rank;  // of two points that crowd, the one with the smaller rank stays
};

const uint kNobody = 0xffffffffu;
const float kFar = 3.0e38;
const uint kOtherSheet = 0x80000000u;  // in the slot of a kept neighbour
const uint kExamined = 0x80000000u;    // in a rank
layout(constant_id = 2) const uint kSubgroups = 64;  // of a workgroup

// Walks over the neighbours, one after another: each needs the result of the one before.
const uint kWalkAround = 0;   // distance of the nearest in each sector, and the points that crowd this one
const uint kWalkYields = 1;   // whether the first of those has to yield itself
const uint kWalkIds = 2;      // the smallest id of the nearest in each sector
const uint kWalkNearest = 3;  // the neighbour with that id
const uint kWalkBlocks = 4;   // neighbours that block a new point
const uint kWalkRisen = 5;    // while a ball carves: whether the new point would be outside the solid
const uint kWalkNoMore = 6;

uint walk;
vec3 center;
Seen self;
uint selfSlot, selfId;
// Data of points, by their ids.
uint tick, firstNew;
bool requests;  // points may request anything
bool fills;     // new points are requested: ids are left, or many would be requested in every tick
Uints examinedOf, parentsOf;
Floats spacings;
Places rests;
float reach;  // of the point that decides: how far from it a new one may be created
vec3 axisU, axisV;
// Of this invocation's neighbours.
uint firstRank, firstSlot;  // of those that crowd the point
CarriedSums carriedSums;
bool through;               // the point has passed through the sheet of one of them
vec2 votes;                 // weights of the points at rest: of those that it has risen over, and of all
Seen first;
bool firstYields;
uint blocked;  // a bit for each sector
uint requested;   // the sector in which a new point is requested; kGapSectors: none
bool crowded, leaves;
bool carves, moved;  // a brush has moved the point since it was created
bool anyBlocked;     // by this stroke
bool looks;          // the stroke has moved the point, and it looks at what lies ahead
bool bends;          // the stroke has bent the surface so far that the side of its normal is to be found
bool cuts, swallowed;       // a ball cuts; it removes the point
vec3 foundAt, foundNormal;  // of these two: as the stroke found the point, from its present position
Path path;                  // along which the brush moves it
float free;                 // how far it may go on; while a ball cuts: depth of the far sheet under it as found
Brush brush;
BrushTool tool;

// State of a sector in a subgroup. Distances are compared as bits, which for these have the same order.
struct Sector {
  uint distance;
  uint id;
  uint slot;
  vec3 offset;    // of the neighbour; then of the new point, kFar for none
  float spacing;  // of a gap: the wider target of its ends
};
shared Sector sectors[kSubgroups * kGapSectors];
uint sectorAt(uint s) { return gl_SubgroupID * kGapSectors + s; }

// Points examined in this tick rank after all others.
uint rankOf(uint id) { return ((examinedOf.at[id] & ~kIsBlocked) == (kIsExamined | tick) ? kExamined : 0u) | id; }
float targetOf(uint id) { return spacings.at[id < firstNew ? id : parentsOf.at[id - firstNew]]; }
bool sameSheet(vec3 a, vec3 b) { return dot(a, b) > kSameSheet; }
bool isNew(Seen point) { return (point.rank & 0x7fffffffu) >= firstNew; }
bool hasToYield(Seen point, Seen other) {
  if (other.rank >= point.rank || !sameSheet(point.normal, other.normal)) return false;
  const bool anyNew = isNew(point) || isNew(other);
  const float least = min(point.spacing, other.spacing);
  const float closest = kCrowded * (anyNew ? max(point.spacing, other.spacing) : least);
  const float now = distance(point.offset, other.offset), before = distance(point.rest, other.rest);
  return now < closest && (anyNew || now < kComeNearer * before || before < kSamePlace * least);
}
bool isAtRest(vec3 position, vec3 rest, float spacing) { return distance(position, rest) <= kAtRest * spacing; }
bool nearer(vec3 d, float than) { return dot(d, d) < than * than; }
Seen seenAt(uint at, uint slot) {
  const uint id = keptIds[at];
  return Seen(keptOffset(at), args.cloud.normals.at[slot].xyz, rests.at[id], targetOf(id), rankOf(id));
}

// Maximum distance at which a point crowds another one.
float mostCrowded() { return kCrowded * kMaxSpacing * args.radius; }

void noteCrowding(uint at, uint slot) {
  const Seen other = seenAt(at, slot);
  if (!hasToYield(self, other) || other.rank >= firstRank) return;
  firstRank = other.rank;
  firstSlot = slot;
}

void noteYielding(uint at, uint slot) {
  firstYields = firstYields || hasToYield(first, seenAt(at, slot));
}

#include "shaders/lib/carved_solid.glsl"
#include "shaders/lib/found_sides.glsl"

// Whether the brush moves a neighbour, or does not reach it.
bool movesAlong(uint id, vec3 position, vec3 normal) {
  if (args.tables.at[0].founds.at[id].stroke == tool.stroke) return true;
  if (isLocked(args.tables, id)) return false;
  const vec3 away = position - tool.middle;
  if (!(dot(away, away) < tool.reach * tool.reach)) return true;
  const uint cell = connectedCell(tool, FoundPoint(position, normal, 0.0, 0.0));
  return (args.tables.at[0].tool.at[0].connected[cell / 32] >> (cell % 32) & 1) != 0;
}

void noteAhead(uint at, vec3 normal, vec3 d) {
  const uint id = keptIds[at];
  if (anyBlocked && (examinedOf.at[id] & kIsBlocked) != 0) {
    const Found blocked = args.tables.at[0].founds.at[id];
    if (blocked.stroke == tool.stroke)
      free = freeBeside(brush, path, d, blocked.position - (center + d), blocked.normal, free);
  }
  if (!isBeside(path, d)) return;
  // For most neighbours it does not matter whether the brush moves them, which takes loads to find out.
  const float along = freeUntil(brush, tool, path, SeenPoint(d, normal, true), free);
  const float staying = freeUntil(brush, tool, path, SeenPoint(d, normal, false), free);
  free = along == staying || movesAlong(id, center + d, normal) ? along : staying;
}

// Blocks new points that would crowd a neighbour with a wider target, or one of another sheet that may turn out to be
// their own, so that they would be removed again.
void noteCrowded(uint at, uint slot, vec3 d) {
  for (uint s = 0; s < kGapSectors; ++s) {
    const Sector gap = sectors[sectorAt(s)];
    if (!nearer(d - gap.offset, mostCrowded())) continue;
    if (!nearer(d - gap.offset, kCrowded * max(gap.spacing, targetOf(keptIds[at])))) continue;
    const vec3 facing = self.normal + args.cloud.normals.at[gap.slot].xyz;
    if (dot(facing, args.cloud.normals.at[slot].xyz) > kFarSheet * length(facing)) blocked |= 1u << s;
  }
}

void visitNeighbour(uint at) {
  uint slot = keptSlot(at);
  if (slot == selfSlot) return;
  const vec3 d = keptOffset(at);
  if (walk == kWalkBlocks) noteCrowded(at, slot & ~kOtherSheet, d);
  if (carves && walk == kWalkBlocks && (slot & kOtherSheet) != 0) noteThrough(slot & ~kOtherSheet, d);
  if (walk == kWalkRisen) {
    const vec3 normal = args.cloud.normals.at[slot & ~kOtherSheet].xyz;
    if (dot(self.normal, normal) > kFarSheet)
      noteRisen(at, normal, d - sectors[sectorAt(requested)].offset, kBirthMargin);
    return;
  }
  if (walk == kWalkYields) {
    if (nearer(d - first.offset, mostCrowded())) noteYielding(at, slot & ~kOtherSheet);
    return;
  }
  if (!visitedBefore) {
    const vec3 normal = args.cloud.normals.at[slot].xyz;
    if (carves && walk == kWalkAround) noteOutside(at, normal, d);
    if (cuts && walk == kWalkAround) noteFarSheet(normal, d);
    if (looks && walk == kWalkAround) noteAhead(at, normal, d);
    if (bends && walk == kWalkAround) noteCarried(at, normal, d);
    if (!requests) return;
    if (!sameSheet(self.normal, normal)) slot |= kOtherSheet;
    if (carves && walk == kWalkBlocks && (slot & kOtherSheet) != 0) noteThrough(slot & ~kOtherSheet, d);
    keptNeighbours[at].w = uintBitsToFloat(slot);
  }
  if ((slot & kOtherSheet) != 0) return;
  if (walk == kWalkBlocks) {
    for (uint s = 0; s < kGapSectors; ++s)
      if (nearer(d - sectors[sectorAt(s)].offset, kMinClearance * sectors[sectorAt(s)].spacing)) blocked |= 1u << s;
    return;
  }
  if (walk == kWalkAround && nearer(d, mostCrowded())) noteCrowding(at, slot);
  precise const float size = length(d);
  precise const float alongU = dot(d, axisU), alongV = dot(d, axisV);
  const uint s = sectorAt(sectorOf(alongU, alongV));
  const uint distance = floatBitsToUint(size);
  if (walk == kWalkAround)
    atomicMin(sectors[s].distance, distance);
  else if (sectors[s].distance == distance) {
    if (walk == kWalkIds)
      atomicMin(sectors[s].id, keptIds[at]);
    else if (sectors[s].id == keptIds[at]) {
      sectors[s].slot = slot;
      sectors[s].offset = d;
    }
  }
}

void begin() {
  frameAround(self.normal, axisU, axisV);
  firstRank = kNobody;
  firstSlot = kNobody;
  firstYields = false;
  blocked = 0;
  requested = kGapSectors;
  through = false;
  free = looks ? kFreeAhead * neighbourhoodRadius(self.spacing, args.radius) : kUnseen;
  votes = vec2(0.0);
  carriedSums = CarriedSums(vec4(0.0), vec4(0.0), vec3(0.0), vec3(0.0), 0.0);
  crowded = false;
  leaves = false;
  for (uint s = gl_SubgroupInvocationID; s < kGapSectors; s += gl_SubgroupSize) {
    sectors[sectorAt(s)].distance = floatBitsToUint(kFar);
    sectors[sectorAt(s)].id = kNobody;
  }
  subgroupShares();
}

// Finds the first of the points that crowd this one, which is removed unless that one has to yield itself.
bool findFirst() {
  const uint least = reduceMin(firstRank);
  crowded = least != kNobody;
  if (!crowded) return false;
  const uint slot = reduceMin(firstRank == least ? firstSlot : kNobody);
  const vec4 position = args.cloud.positions.at[slot];
  const uint id = floatBitsToUint(position.w);
  first = Seen(position.xyz - center, args.cloud.normals.at[slot].xyz, rests.at[id], targetOf(id), least);
  return true;
}

bool isWide(uint s) {
  const float distance = uintBitsToFloat(sectors[sectorAt(s)].distance);
  return distance < kFar && distance > kWidestGap * self.spacing;
}
bool anyWide() {
  bool wide = false;
  for (uint s = gl_SubgroupInvocationID; s < kGapSectors; s += gl_SubgroupSize) wide = wide || isWide(s);
  return subgroupAny(wide);
}

// Whether an edit has moved the ends of a gap relative to each other.
bool torn(Sector gap) {
  return distance(gap.offset, rests.at[gap.id] - self.rest) > kTorn * max(self.spacing, targetOf(gap.id));
}

vec3 middleNormal(vec3 normal, vec3 other) {
  const vec3 sum = normal + other;
  const float size = length(sum);
  return size > 1e-3 ? sum / size : normal;
}

// Whether this stroke has inserted a point at exactly this position before: it did not stay.
bool wasGranted(vec3 place) {
  const uint at = claimAt(claimsFor(args.radius), place);
  return args.lists.grantedIn[at] == tool.stroke && args.lists.grantedAt[at] == place;
}

// Positions of new points in the middle of wide gaps; false if there are none.
bool placeInGaps() {
  bool any = false;
  for (uint s = gl_SubgroupInvocationID; s < kGapSectors; s += gl_SubgroupSize) {
    vec3 place = vec3(kFar);
    const uint at = sectorAt(s);
    if (isWide(s)) {
      const float spacing = max(self.spacing, targetOf(sectors[at].id));
      sectors[at].spacing = spacing;
      if (uintBitsToFloat(sectors[at].distance) > kWidestGap * spacing && torn(sectors[at])) {
        const vec3 middle = halfWay(sectors[at].offset, self.normal, args.cloud.normals.at[sectors[at].slot].xyz);
        if (!nearer(middle, kMinClearance * spacing) && nearer(middle, reach) && !wasGranted(center + middle) &&
            mayBeFilled(foundEnds(sectors[at].id, sectors[at].slot), sectors[at]))
          place = middle;
      }
    }
    sectors[sectorAt(s)].offset = place;
    any = any || place.x < kFar;
  }
  subgroupShares();
  return subgroupAny(any);
}

// The sector with the narrowest gap that no point fills yet; kGapSectors if there is none.
uint openGap() {
  const uint taken = reduceOr(blocked);
  uint best = kGapSectors;
  float narrowest = kFar;
  for (uint s = 0; s < kGapSectors; ++s) {
    const float distance = uintBitsToFloat(sectors[sectorAt(s)].distance);
    if (sectors[sectorAt(s)].offset.x == kFar || (taken & 1u << s) != 0 || distance >= narrowest) continue;
    best = s;
    narrowest = distance;
  }
  return best;
}

// Selects the next gap; while a ball carves, a walk has to find out first whether the new point would be outside.
uint takeUpGap() {
  requested = openGap();
  votes = vec2(0.0);
  return carves && requested < kGapSectors ? kWalkRisen : kWalkNoMore;
}

// The next walk.
uint nextWalk() {
  if (!requests) return kWalkNoMore;
  if (walk == kWalkAround && isOutside()) {
    leaves = true;
    return kWalkNoMore;
  }
  if (walk == kWalkAround && findFirst()) {
    // A point that is not examined in this tick does not yield.
    if (first.rank >= kExamined) return kWalkYields;
    leaves = true;
    return kWalkNoMore;
  }
  if (walk == kWalkYields) leaves = !subgroupAny(firstYields);
  if (walk <= kWalkYields) return leaves || !fills || !allAreSeen || !anyWide() ? kWalkNoMore : kWalkIds;
  if (walk == kWalkIds) return kWalkNearest;
  if (walk == kWalkNearest) return placeInGaps() ? kWalkBlocks : kWalkNoMore;
  if (walk == kWalkBlocks) return takeUpGap();
  if (!hasRisen(kHalfOfThem)) return kWalkNoMore;
  blocked |= 1u << requested;
  return takeUpGap();
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

// Called by one invocation.
void requestFor(uint id, vec3 center, uint sector) {
  const uint at = atomicAdd(args.lists.now.requests, 1);
  if (at >= args.most) return;
  if (leaves) args.cloud.normals.at[selfSlot].w = kMarkGoes;
  args.lists.requests[at].position = center;
  args.lists.requests[at].id = id;
  const bool inserts = sector < kGapSectors;
  args.lists.requests[at].inserts = inserts ? 1 : 0;
  if (!inserts) return;
  const Sector gap = sectors[sectorAt(sector)];
  const vec3 place = center + gap.offset;
  const FoundEnds ends = foundEnds(gap.id, gap.slot);
  args.lists.requests[at].place = place;
  args.lists.requests[at].normal = middleNormal(self.normal, args.cloud.normals.at[gap.slot].xyz);
  args.lists.requests[at].found = 0.5 * (ends.position + ends.otherPosition);
  args.lists.requests[at].foundNormal = middleNormal(ends.normal, ends.otherNormal);
  args.lists.requests[at].color = middleColor(colorOf(args.tables, id), colorOf(args.tables, gap.id));
  const bool otherIsLocked = isLocked(args.tables, gap.id);
  const bool takesAfterOther =
      otherIsLocked || (targetOf(gap.id) > self.spacing && !isLocked(args.tables, id));
  args.lists.requests[at].parent = parentOf(args.tables, takesAfterOther ? gap.id : id);
  args.lists.requests[at].other = gap.id;
  args.lists.requests[at].reach = reach - length(gap.offset);
  atomicMin(args.lists.claims[claimAt(claimsFor(args.radius), place)], id);
}

void requestForAll() {
  tick = args.lists.now.tick & kTickBits;
  requests = resamples(args.tables);
  fills = args.lists.now.nextId < args.tables.at[0].ids && args.tables.at[0].tool.at[0].tool.closes == 0;
  firstNew = args.tables.at[0].firstNew;
  examinedOf = args.tables.at[0].examined;
  parentsOf = args.tables.at[0].parents;
  spacings = args.tables.at[0].spacings;
  rests = args.tables.at[0].rests;
  brush = args.tables.at[0].brush.at[0];
  carves = brushHas(brush, kRemovesPoints);
  tool = args.tables.at[0].tool.at[0].tool;
  anyBlocked = args.lists.now.blocked == tool.stroke;
  cuts = carves && tool.acts != 0;
  const uint changed = args.update.at[0].changed;
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint which = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; which < changed; which += stride) {
    selfSlot = args.changed.at[which];
    const vec4 fitted = args.fitted.at[which];
    if (fitted.w == kNotExamined) continue;
    const vec4 position = args.cloud.positions.at[selfSlot];
    const uint id = floatBitsToUint(position.w);
    selfId = id;
    self = Seen(vec3(0.0), fitted.xyz, rests.at[id], fitted.w, kExamined | id);
    center = position.xyz;
    const float mostReach = kReach * args.radius;
    reach = id < firstNew ? mostReach : args.tables.at[0].reaches.at[id - firstNew];
    const uint stroke = args.tables.at[0].founds.at[id].stroke;
    const bool isNoted = stroke == tool.stroke, isHeld = isLocked(args.tables, id);
    bends = stroke != 0 && dot(fitted.xyz, args.tables.at[0].founds.at[id].normal) <= kCarriedFar;
    looks = isNoted && tool.acts != 0 && brushHas(brush, kLooksAhead);
    if (!bends && subgroupElect()) args.tables.at[0].carried.at[id] = 0;
    if (!requests && !looks && !bends) continue;
    moved = id < firstNew ? !isAtRest(center, self.rest, self.spacing) : reach == mostReach;
    swallowed =
        cuts && !isHeld && lockOf(args.tables, id) <= 0.5 && carved(brush, tool, center, self.normal).taken != 0;
    foundAt = foundNormal = vec3(0.0);
    if (cuts || looks) {
      foundNormal = isNoted ? args.tables.at[0].founds.at[id].normal : self.normal;
      if (isNoted) foundAt = args.tables.at[0].founds.at[id].position - center;
      path = pathOf(brush, tool, center, FoundPoint(center + foundAt, foundNormal, 0.0, lockOf(args.tables, id)),
                    self.spacing);
    }
    begin();
    for (walk = kWalkAround; walk != kWalkNoMore; walk = nextWalk()) {
      visitNeighbours(center, neighbourhoodRadius(self.spacing, args.radius), walkBudget(kMaxExamined),
                      walk != kWalkAround);
      subgroupShares();
    }
    if (looks) {
      free = reduceMin(free);
      if (subgroupElect()) args.tables.at[0].founds.at[id].room = free;
    }
    const bool isTurned = bends && noteSide() && requests && tool.closes == 0;
    if (subgroupElect() && (leaves || crowded || isTurned || (isHeld && tool.acts != 0) || requested < kGapSectors))
      requestFor(id, center, requested);
    subgroupShares();
  }
}

void main() {
  if (args.update.at[0].failed == 0) requestForAll();
  if (!finishesLast(args.update)) return;
  if (args.update.at[0].failed == 0)
    confirmClaims(args.lists, args.most, args.radius, gl_LocalInvocationIndex, gl_WorkGroupSize.x);
  if (gl_LocalInvocationIndex == 0) args.update.at[0].finished = 0;
}
