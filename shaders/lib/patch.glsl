// The patch of points around the probe, in shared memory, and in a buffer for the rest: gathered through the spatial
// hash by this workgroup, or taken over from others.
#ifndef PALPATE_LIB_PATCH_GLSL
#define PALPATE_LIB_PATCH_GLSL

#include "shaders/lib/candidates.glsl"
#include "shaders/lib/probe.glsl"
#include "shaders/shared/motion.h"

layout(constant_id = 6) const uint kSharedPatch = kMaxSharedPatch;
layout(constant_id = 8) const bool kNormalsTurn = false;
shared vec3 patchPositions[kSharedPatch];  // relative to patchCentre
shared vec3 patchNormals[kSharedPatch];
const uint kSharedIds = kPointsMove ? kSharedPatch : 1;
shared uint patchIds[kSharedIds];

vec3 patchCentre = vec3(0.0);  // relative to the HIP, like every position in the step
uint patchCount = 0;
uint patchSpill = 0;  // start of its part of the spill buffer
bool patchGathered = false;
bool patchThinned = false;  // a gather of this step subsampled the candidates
uint workDone = 0;
float patchAge = 0.0;            // of the points, s
vec3 patchVelocity = vec3(0.0);  // of the surface in whose frame the points are

uint spilledAt(uint i) { return patchSpill + 2 * (i - kSharedPatch); }
vec3 patchPosition(SpilledPoints spill, uint i) {
  return i < kSharedPatch ? patchPositions[i] : spill.at[spilledAt(i)].xyz;
}
vec3 patchNormal(SpilledPoints spill, uint i) {
  return i < kSharedPatch ? patchNormals[i] : spill.at[spilledAt(i) + 1].xyz;
}
uint patchId(SpilledPoints spill, uint i) {
  return i < kSharedPatch ? patchIds[i] : floatBitsToUint(spill.at[spilledAt(i)].w);
}

// Extrapolates a moving point to the time of the question.
void goOn(uint id, inout vec3 place, inout vec3 normal) {
  if (patchAge == 0.0) return;
  place = placeAfter(place, args.velocities.at[id].xyz, patchVelocity, patchAge);
  if (kNormalsTurn) normal = normalAfter(normal, args.velocities.at[args.cloud.slots + id].xyz, patchAge);
}

void keepPoint(SpilledPoints spill, uint i, vec4 position, vec3 normal) {
  if (kPointsMove) {
    vec3 place = position.xyz;
    goOn(floatBitsToUint(position.w), place, normal);
    position.xyz = place;
  }
  if (i < kSharedPatch) {
    patchPositions[i] = position.xyz;
    patchNormals[i] = normal;
    if (kPointsMove) patchIds[i] = floatBitsToUint(position.w);
  } else {
    spill.at[spilledAt(i)] = position;
    spill.at[spilledAt(i) + 1] = vec4(normal, 0.0);
  }
}

void chargeSteps(uint steps) { workDone += steps * (1 + gl_NumSubgroups); }  // a scan loops over the subgroups

void patchIsAt(vec3 centre, uint count) {
  if (count > kSharedPatch) memoryBarrierBuffer();  // half a microsecond on an H100
  barrier();
  patchCentre = centre;
  patchCount = count;
  patchGathered = true;
}

// Fills the patch around `centre`, relative to `hip`. All invocations call it together with the same arguments.
void gatherPatch(SpilledPoints spill, vec3 hip, vec3 centre, float reach, uint mostCells) {
  const CellBox box = boxAround(hip + centre, reach, mostCells);
  uint count = 0;
  barrier();  // the last evaluation may still be reading the old patch
  for (uint first = 0; first < box.cells; first += kContactWorkgroup) {
    uint inCell;
    const uint total = loadRound(box, first, inCell);
    const uint stride = strideOf(total, kPatchRoundCandidates);
    const uint taken = takenOf(total, stride);
    patchThinned = patchThinned || stride > 1;
    // Two candidates of an invocation at once, so that their loads overlap, and one scan counts both.
    for (uint base = 0; base < taken; base += 2 * kContactWorkgroup) {
      const uint k = base + scanIndex(), l = k + kContactWorkgroup;
      Candidate one = Candidate(false, 0, vec4(0.0), vec3(0.0)), two = one;
      if (k < taken) one = candidateAt(box, first, k * stride, hip, centre, reach);
      if (l < taken) two = candidateAt(box, first, l * stride, hip, centre, reach);
      uint kept;
      const uvec2 places = count + workgroupExclusiveCounts(one.kept, two.kept, kept);
      if (one.kept) keepPoint(spill, places.x, one.place, one.normal);
      if (two.kept) keepPoint(spill, places.y, two.place, two.normal);
      count += kept;
    }
    chargeSteps(patchSteps(taken));
    barrier();
  }
  patchIsAt(centre, count);
}

// Takes over a patch whose segments others have filled. It is charged the cost of gathering it here, so that a step
// that runs out of budget ends at the same point with every method.
void takePatch(GatheredPatch gathered, SpilledPoints spill) {
  const uint lane = scanIndex();
  const uint segments = gathered.header.segments;
  uint count = 0;
  for (uint first = 0; first < segments; first += kContactWorkgroup) {
    const uvec2 segment = first + lane < segments ? gathered.segments[first + lane] : uvec2(0);
    uint total;
    cellStart[lane] = workgroupExclusiveScan(segment.y, total);
    cellFirst[lane] = segment.x;
    barrier();
    for (uint i = lane; i < total; i += kContactWorkgroup) {
      const uint at = cellOfCandidate(i);
      const uint slot = cellFirst[at] + i - cellStart[at];
      keepPoint(spill, count + i, gathered.points[2 * slot], gathered.points[2 * slot + 1].xyz);
    }
    count += total;
    barrier();
  }
  patchThinned = gathered.header.thinned != 0;
  chargeSteps(gathered.header.steps);
  patchIsAt(gathered.header.centre, count);
}

#endif
