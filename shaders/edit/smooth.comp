#version 460
#extension GL_GOOGLE_include_directive : require
// Smoothing: each selected point moves by its share of the distance to the algebraic sphere of its neighbours, all of
// them at their positions before. One subgroup for each.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"
#include "shaders/shared/surface.h"

layout(push_constant, scalar) uniform Push { SmoothArgs args; };
#include "shaders/lib/brush_reach.glsl"
#include "shaders/lib/neighbours.glsl"

vec3 facing;       // the side of the sheet that is smoothed
float radius;      // of the neighbourhood
SurfaceSums sums;  // of this invocation's neighbours

void visitNeighbour(uint id, vec3 n, vec3 d) {
  const vec3 offset = d / radius;
  const float squared = dot(offset, offset);
  const float w = wendland(sqrt(squared)) * facingWeight(dot(n, facing));
  if (w <= 0.0) return;
  sums.offsets += w * vec4(offset, 1.0);
  sums.normals += vec4(w * n, 1.0);
  sums.products += w * vec2(squared, dot(offset, n));
}

Surface surfaceAbout(vec3 place) {
  sums = SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0));
  visitNeighbours(place, radius, kNeighbourWorkBudget);
  const SurfaceSums all =
      SurfaceSums(reduceAdd(sums.offsets), reduceAdd(sums.normals), reduceAdd(sums.products));
  return surfaceFrom(all, radius, kSurfaceSphere);
}

void main() {
  takeUpBrush(args.brush, args.tool);
  UpdateLists update = updateLists();
  PointMoves list = PointMoves(update.moves);
  const uint moves = min(args.update.at[0].moves, update.mostMoves);
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  uint blocked = 0;
  for (uint i = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; i < moves; i += stride) {
    const vec3 place = list.at[i].position;
    facing = list.at[i].normal;
    const uint parent = parentOf(args.tables, list.at[i].id);
    radius = neighbourhoodRadius(args.tables.at[0].spacings.at[parent], brush.support);
    const Surface surface = surfaceAbout(place);
    const FoundPoint found = foundPoint(list.at[i].id, place, facing);
    const bool goes = list.at[i].toBucket == kNoBucket;
    if (surface.defined && !goes && mayBlock(brush, found) && isActedOn(found)) {
      const vec3 free = smoothed(brush, tool, place, withRoom(found), surface.distance, surface.normal);
      if (isBlocked(brush, place, found, free)) ++blocked;
    }
    if (surface.defined && !goes && subgroupElect()) {
      const vec3 to = smoothed(brush, tool, place, found, surface.distance, surface.normal);
      const uint from = list.at[i].fromBucket;
      const uint bucket = bucketAt(to);
      list.at[i].position = to;
      list.at[i].toBucket = bucket;
      if (bucket != from) touchBuckets(update, from, bucket, i);
    }
  }
  if (blocked > 0 && subgroupElect()) atomicAdd(args.update.at[0].blocked, blocked);
}
