#version 460
#extension GL_GOOGLE_include_directive : require
// Sums over the pairs of pixels and points of the map by workgroups; the host adds up theirs in double precision. Every
// sum has a fixed order: an invocation's own pixels, then the invocations of the workgroup.
#include "shaders/lib/index.glsl"
#include "shaders/lib/fusion_buffers.glsl"
#include "shaders/shared/icp_passes.h"

layout(push_constant, scalar) uniform Push { IcpSumsArgs args; };

shared float sums[kIcpSums][kIcpWorkgroup];

IcpView queryOf(IcpViews queries) {
  IcpView query;
  query.right = queries.at[0].right;
  query.down = queries.at[0].down;
  query.ahead = queries.at[0].ahead;
  query.centre = queries.at[0].centre;
  query.pivot = queries.at[0].pivot;
  query.scale = queries.at[0].scale;
  query.gate = queries.at[0].gate;
  return query;
}

void addPair(IcpPair pair, float feigned, uint own) {
  const float row[kIcpUnknowns] =
      float[](pair.turn.x, pair.turn.y, pair.turn.z, pair.shift.x, pair.shift.y, pair.shift.z);
  uint entry = 0;
  for (uint i = 0; i < kIcpUnknowns; ++i)
    for (uint j = i; j < kIcpUnknowns; ++j) sums[entry++][own] += pair.weight * row[i] * row[j];
  for (uint i = 0; i < kIcpUnknowns; ++i) sums[kIcpRightSide + i][own] += pair.weight * row[i] * pair.residual;
  sums[kIcpWeights][own] += pair.weight;
  sums[kIcpSquares][own] += pair.weight * pair.residual * pair.residual;
  sums[kIcpFeigned][own] += pair.weight * feigned;
  sums[kIcpPairs][own] += 1;
}

void addPixel(FusionView view, IcpView query, uvec2 pixel, uint own) {
  const uint index = pixel.y * view.width + pixel.x;
  const PixelSurface surface = surfaceAt(args.surfaces, index);
  if (!(surface.depth > 0)) return;
  sums[kIcpSeen][own] += 1;
  const float depth = args.depths.at[index];
  const mat3 turn = mat3(query.right, query.down, query.ahead);
  const vec3 measured = query.centre + turn * placeOfPixel(view, pixel, depth);
  const Projection projection = projectionOf(view, measured);
  if (!projection.inView) return;
  const uint front = projection.pixel.y * view.width + projection.pixel.x;
  if (args.ids.at[front] == kEmptySlot) return;
  const vec4 place = args.frontPlaces.at[front];
  const Oriented seen = Oriented(measured, turn * surface.normal);
  const Oriented mapped = Oriented(place.xyz, args.frontNormals.at[front].xyz);
  const Pairing pairing = Pairing(query.pivot, query.scale, query.gate);
  const IcpPair pair = icpPair(seen, mapped, pairing, depthDeviation(view.sensor.noise, depth));
  if (pair.isPair) addPair(pair, normalVariance(view, depth, place.w), own);
}

void main() {
  const uint group = workgroupIndex(), own = gl_LocalInvocationIndex;
  if (group >= args.groups) return;
  for (uint entry = 0; entry < kIcpSums; ++entry) sums[entry][own] = 0;
  const FusionView view = viewOf(args.view);
  const IcpView query = queryOf(args.query);
  const uint columns = (view.width + args.stride - 1) / args.stride;
  const uint rows = (view.height + args.stride - 1) / args.stride;
  for (uint turn = 0; turn < kIcpPixels; ++turn) {
    const uint one = (group * kIcpPixels + turn) * kIcpWorkgroup + own;
    if (one < columns * rows) addPixel(view, query, args.stride * uvec2(one % columns, one / columns), own);
  }
  barrier();
  if (own >= kIcpSums) return;
  float sum = 0;
  for (uint i = 0; i < kIcpWorkgroup; ++i) sum += sums[own][i];
  args.sums.at[group * kIcpSums + own] = sum;
}
