// Selection and slots of the points that a gather visits: the arithmetic shared by all query methods, so that their
// patches are bitwise identical.
#pragma once

#include "engine/cuda/block_scan.cuh"
#include "engine/cuda/step_args.hpp"
#include "shaders/shared/proxy.h"

namespace palpate::cu {

using namespace shared;

/// Points are aligned to 16 bytes and read in one access, which glm::vec4 alone would not guarantee.
inline __device__ float4 loadPoint(std::uint64_t points, uint i) {
  const float4* const at = reinterpret_cast<const float4*>(points) + i;
  __builtin_assume(__isGlobal(at));
  return *at;
}
inline __device__ vec3 xyz(const float4& v) { return {v.x, v.y, v.z}; }

/// The state of the last tick relative to the HIP of this one.
struct Before {
  vec3 lastHip;  // all zero before the first tick
  vec3 proxy;
  vec3 facing;
  bool started;
  bool touching;
  bool sticking;
  uint face;
};
inline __device__ Before stateBefore(const ContactState& state, const vec3& hip) {
  const bool started = state.started != 0;
  Before before;
  before.started = started;
  before.lastHip = started ? state.lastHip - hip : vec3(0.0f);
  before.touching = started && state.touching != kFree;
  before.sticking = started && state.touching == kSticking;
  before.face = started ? state.face : kFaceUnknown;
  before.facing = started ? state.facing : vec3(0.0f);
  before.proxy = before.touching ? state.spring + before.lastHip : vec3(0.0f);
  return before;
}

/// The displacement of the HIP since the last tick, in the unit of substepsOn().
inline __device__ float wayOf(const Before& before, float radius) {
  return glm::length(before.lastHip) / (kLongestStep * radius);
}
inline __device__ vec3 freePlace(const Before& before, uint step, uint steps) {
  return before.lastHip * (float(steps - step) / float(steps));
}

/// The first position at which a tick evaluates the surface, relative to the HIP: the centre of the first gather.
inline __device__ vec3 firstPlace(const Before& before, float radius) {
  return before.touching ? before.proxy : freePlace(before, 1, substepsOn(wayOf(before, radius)));
}

inline __device__ float patchReach(float radius) { return radius + kPatchSlack * radius; }

inline __device__ CellBox boxAround(const CloudView& cloud, const vec3& hip, const vec3& centre, float reach) {
  const float margin = 1.001f * reach;  // hip + centre is rounded
  CellBox box;
  box.low = cellOf(cloud.grid, hip + centre - margin);
  box.size = uvec3(cellOf(cloud.grid, hip + centre + margin) - box.low + 1);
  const unsigned long long plane = 1ull * box.size.x * box.size.y;
  box.cells = cloud.slots == 0 ? 0 : uint(min(plane * min(box.size.z, kPatchMaxCells), 1ull * kPatchMaxCells));
  return box;
}
inline __device__ ivec3 cellAt(const CellBox& box, uint c) {
  return box.low + ivec3(c % box.size.x, c / box.size.x % box.size.y, c / box.size.x / box.size.y);
}

/// First and one-past-last point of the bucket of cell `c`; empty past the last cell.
inline __device__ uint2 rangeOfCell(const CloudView& cloud, const CellBox& box, uint c) {
  if (c >= box.cells) return make_uint2(0, 0);
  return reinterpret_cast<const uint2*>(cloud.ranges)[bucketOf(cloud.grid, cellAt(box, c))];
}
/// Limited so that the sum over a round of cells stays within 32 bits.
inline __device__ uint candidatesIn(const uint2& range) { return min(range.y - range.x, 1u << 22); }

/// Subsampling stride for a round's candidates.
inline __device__ uint strideFor(uint candidates) {
  return max(1u, (candidates + kPatchRoundCandidates - 1) / kPatchRoundCandidates);
}

/// The run of one cell whose candidates are numbers `start` to `start + count` of its round.
inline __device__ CellRun runOf(uint cell, uint firstPoint, uint start, uint count, uint stride, uint roundSlots) {
  const uint firstTaken = (start + stride - 1) / stride;
  const uint pastTaken = (start + count + stride - 1) / stride;
  return {cell, firstPoint + (firstTaken * stride - start), stride, pastTaken - firstTaken, roundSlots + firstTaken};
}

/// Whether a point belongs to a gather via `cell`: another cell of the gather may share the bucket, and a point is
/// taken only for its own cell.
inline __device__ bool inReach(const CloudView& cloud, const vec3& absolute, const ivec3& cell, const vec3& relative,
                               float reach) {
  return cellOf(cloud.grid, absolute) == cell && glm::dot(relative, relative) < reach * reach;
}

/// Tests candidate `j` of a run and writes the result to the run's slot.
inline __device__ void fillSlot(const StepArgs& args, const Gather& gather, const CellRun& run, uint j) {
  const uint i = run.first + j * run.stride;
  const vec3 absolute = xyz(loadPoint(args.cloud.positions, i));
  const vec3 relative = (absolute - gather.hip) - gather.centre;
  const bool keep = inReach(args.cloud, absolute, cellAt(gather.box, run.cell), relative, gather.reach);
  float4* const slot = reinterpret_cast<float4*>(args.slots) + 2 * (run.slot + j);
  slot[0] = make_float4(relative.x, relative.y, relative.z, keep ? 1.0f : 0.0f);
  if (keep) slot[1] = loadPoint(args.cloud.normals, i);
}

/// The gather for a pose, without its cells.
inline __device__ Gather gatherFor(const StepArgs& args, const ContactPose& pose) {
  Gather gather{};
  gather.hip = pose.hip;
  gather.centre = firstPlace(stateBefore(*args.state, pose.hip), args.radius);
  gather.reach = patchReach(args.radius);
  return gather;
}

}  // namespace palpate::cu
