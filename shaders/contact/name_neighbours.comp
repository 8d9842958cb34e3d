#version 460
#extension GL_GOOGLE_include_directive : require
// For every point with a plane the nearest neighbours all around it, along which the host propagates the signs of the
// normals. One invocation for each point.
#include "shaders/lib/index.glsl"
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/shared/normal_estimate.h"
#include "shaders/shared/plane_fit.h"

layout(push_constant, scalar) uniform Push { NormalEstimateArgs args; };
#include "shaders/lib/bucket_share.glsl"

const float kFar = 3.0e38;

// One of eight sectors of a plane, 45 degrees each.
uint sectorOf(vec2 p) {
  return (p.x < 0.0 ? 1u : 0u) | (p.y < 0.0 ? 2u : 0u) | (abs(p.y) > abs(p.x) ? 4u : 0u);
}

// Points off the plane count as farther, so that of the two sides of a thin sheet the point's own one is nearer.
float lengthAlong(vec3 d, float height) { return dot(d, d) + 8.0 * height * height; }

// Returns the number of sectors with a neighbour.
uint nameNeighbours(vec3 center, vec3 normal, uint id, float radius, inout uint work) {
  const Share share = Share(0, 1);
  const vec3 u = besides(normal), v = cross(normal, u);
  float nearest[kGraphSectors];
  uint who[kGraphSectors];
  for (uint s = 0; s < kGraphSectors; ++s) {
    nearest[s] = kFar;
    who[s] = kNoNeighbour;
  }
  const ivec3 low = cellOf(args.cloud.grid, center - radius);
  const ivec3 high = cellOf(args.cloud.grid, center + radius);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x && work < kEstimateWorkBudget; ++x) {
        const ivec3 cell = ivec3(x, y, z);
        const uvec2 range = bucketWithin(cell, share, kEstimateWorkBudget, work);
        for (uint j = range.x; j < range.y; ++j) {
          const vec4 point = args.cloud.positions.at[j];
          const vec3 d = point.xyz - center;
          const uint other = floatBitsToUint(point.w);
          if (dot(d, d) >= radius * radius || other == id || cellOf(args.cloud.grid, point.xyz) != cell) continue;
          const float far = lengthAlong(d, dot(d, normal));
          const uint sector = sectorOf(vec2(dot(d, u), dot(d, v)));
          if (far < nearest[sector] || far == nearest[sector] && other < who[sector]) {
            nearest[sector] = far;
            who[sector] = other;
          }
        }
      }
  uint named = 0;
  for (uint s = 0; s < kGraphSectors; ++s) {
    args.neighbours.at[id * kGraphSectors + s] = who[s];
    named += who[s] != kNoNeighbour ? 1 : 0;
  }
  return named;
}

void main() {
  const uint i = threadIndex();
  if (i >= args.cloud.slots) return;
  const vec4 point = args.cloud.positions.at[i];
  const uint id = floatBitsToUint(point.w);
  if (id == kEmptySlot) return;
  const vec4 plane = args.planes.at[id];
  if (dot(plane.xyz, plane.xyz) < 0.5) return;
  uint work = 0;
  // Most are found nearby, where fewer points have to be searched.
  const uint named = nameNeighbours(point.xyz, plane.xyz, id, 0.5 * plane.w, work);
  if (named < kEnoughSectors) nameNeighbours(point.xyz, plane.xyz, id, plane.w, work);
  if (work >= kEstimateWorkBudget) args.planes.at[id] = vec4(0.0);
}
