#version 460
#extension GL_GOOGLE_include_directive : require
// For every point with a plane its normal: next to an edge, across which planes are fitted, that of flatter planes
// nearby on which the point lies. engine/cloud/normals.cpp does the same in double precision and gives the reasons. One
// invocation for each point.
#include "shaders/lib/index.glsl"
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/shared/normal_estimate.h"
#include "shaders/shared/weight.h"

layout(push_constant, scalar) uniform Push { NormalEstimateArgs args; };
#include "shaders/lib/bucket_share.glsl"

// What is determined from the planes within the radius, one after the other.
const uint kFlattest = 0, kBest = 1, kSum = 2;
struct Around {
  float flattest;  // minimum variance off a plane
  float most;      // maximum weight of a normal
  uint who;        // id of its point
  vec3 best;       // that normal; all with the sign of the point's own
  vec3 sum;        // weighted sum of the normals close to it
};

void lookAround(vec3 center, vec3 normal, float radius, float spacing2, uint what, inout Around around) {
  uint work = 0;
  const float flatness = kOwnFlatness * kOwnFlatness * spacing2 + kOwnFlatnessOfNoise * around.flattest;
  const float height2 = kOwnHeight * kOwnHeight * spacing2 + kOwnHeightOfNoise * around.flattest;
  const Share share = Share(0, 1);
  const ivec3 low = cellOf(args.cloud.grid, center - radius);
  const ivec3 high = cellOf(args.cloud.grid, center + radius);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x && work < kEdgeWorkBudget; ++x) {
        const ivec3 cell = ivec3(x, y, z);
        const uvec2 range = bucketWithin(cell, share, kEdgeWorkBudget, work);
        for (uint j = range.x; j < range.y; ++j) {
          const vec4 point = args.cloud.positions.at[j];
          const vec3 d = point.xyz - center;
          if (dot(d, d) >= radius * radius || cellOf(args.cloud.grid, point.xyz) != cell) continue;
          const uint other = floatBitsToUint(point.w);
          const vec3 plane = args.planes.at[other].xyz;
          if (dot(plane, plane) < 0.5) continue;
          const float off = args.fits.at[other].x;
          if (what == kFlattest) {
            around.flattest = min(around.flattest, off);
            continue;
          }
          const vec3 like = dot(plane, normal) < 0.0 ? -plane : plane;
          const float height = dot(plane, d);
          const float w = wendland(length(d) / radius) *
                          exp(-max(off - around.flattest, 0.0) / flatness - height * height / height2);
          if (what == kSum && dot(like, around.best) > kSameFace) around.sum += w * like;
          if (what != kBest || w < around.most || w == around.most && other >= around.who) continue;
          around.most = w;
          around.who = other;
          around.best = like;
        }
      }
  if (work >= kEdgeWorkBudget) around.most = -1.0;  // the normal is not changed
}

void main() {
  const uint i = threadIndex();
  if (i >= args.cloud.slots) return;
  const vec4 point = args.cloud.positions.at[i];
  const uint id = floatBitsToUint(point.w);
  if (id == kEmptySlot) return;
  const vec4 plane = args.planes.at[id];
  const vec2 fit = args.fits.at[id];
  args.normals.at[id] = vec4(plane.xyz, 0.0);
  const float from = kEdgeFrom * kEdgeFrom, surely = kEdgeSurely * kEdgeSurely;
  // Early exit for most points: their own plane is flat enough.
  if (dot(plane.xyz, plane.xyz) < 0.5 || fit.x <= from * fit.y) return;
  Around around = Around(fit.x, 0.0, kNoNeighbour, vec3(0.0), vec3(0.0));
  lookAround(point.xyz, plane.xyz, plane.w, fit.y, kFlattest, around);
  const float edge = smoothstep(from, surely, (fit.x - kEdgeOfNoise * around.flattest) / fit.y);
  if (edge <= 0.0 || around.most < 0.0) return;
  lookAround(point.xyz, plane.xyz, plane.w, fit.y, kBest, around);
  if (around.most < kMinEdgeWeight) return;
  lookAround(point.xyz, plane.xyz, plane.w, fit.y, kSum, around);
  args.normals.at[id].xyz = normalize(mix(plane.xyz, normalize(around.sum), edge));
}
