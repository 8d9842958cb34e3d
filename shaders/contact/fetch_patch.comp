#version 460
#extension GL_GOOGLE_include_directive : require
// Fetches the patch of points around a position for the host, as they are in the live cloud, or extrapolated from
// there. One workgroup.
#include "shaders/lib/index.glsl"
#include "shaders/lib/contact_buffers.glsl"

layout(buffer_reference) buffer FetchedPatch;
// Written and read by different invocations.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer NearPoints { uint at[]; };
#include "shaders/shared/motion.h"
#include "shaders/shared/patch.h"
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer FetchedPatch {
  CarriedHead head;
  vec4 points[];
};

layout(push_constant, scalar) uniform Push { PatchFetchArgs args; };
#include "shaders/lib/candidates.glsl"

layout(constant_id = 1) const bool kPointsMove = false;
layout(constant_id = 2) const bool kNormalsTurn = false;

void main() {
  const vec3 centre = args.centre.at[0].xyz;
  const float age = args.centre.at[0].w;
  const CellBox box = boxAround(centre, args.reach, args.mostCells);
  uint near = 0;
  bool thinned = false;
  for (uint first = 0; first < box.cells; first += kContactWorkgroup) {
    uint inCell;
    const uint total = loadRound(box, first, inCell);
    const uint stride = strideOf(total, kPatchRoundCandidates);
    const uint taken = takenOf(total, stride);
    thinned = thinned || stride > 1;
    for (uint base = 0; base < taken; base += kContactWorkgroup) {
      const uint k = base + scanIndex();
      Candidate candidate = Candidate(false, 0, vec4(0.0), vec3(0.0));
      if (k < taken) candidate = candidateAt(box, first, k * stride, centre, vec3(0.0), args.reach);
      uint kept;
      const uint place = near + workgroupExclusiveCount(candidate.kept, kept);
      if (candidate.kept) args.near.at[place] = candidate.point;
      near += kept;
    }
    barrier();
  }
  memoryBarrierBuffer();
  barrier();
  const uint stride = strideOf(near, kMaxCarriedPoints);
  const uint count = takenOf(near, stride);
  for (uint i = scanIndex(); i < count; i += kContactWorkgroup) {
    const uint point = args.near.at[i * stride];
    vec4 position = args.cloud.positions.at[point], normal = args.cloud.normals.at[point];
    if (kPointsMove && age != 0.0) {
      const uint id = floatBitsToUint(position.w);
      position.xyz = placeAfter(position.xyz, args.velocities.at[id].xyz, vec3(0.0), age);
      if (kNormalsTurn)
        normal.xyz = normalAfter(normal.xyz, args.velocities.at[args.cloud.slots + id].xyz, age);
    }
    args.fetched.points[2 * i] = position;
    args.fetched.points[2 * i + 1] = normal;
  }
  if (gl_LocalInvocationIndex != 0) return;
  args.fetched.head.count = count;
  args.fetched.head.thinned = thinned || stride > 1 ? 1 : 0;
}
