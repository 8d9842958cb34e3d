// The patch of points around the probe, gathered through the spatial hash by one workgroup. The order of its points
// follows the hash alone, so that sums over it come out the same every time.
#ifndef PALPATE_LIB_PATCH_GLSL
#define PALPATE_LIB_PATCH_GLSL

#include "shaders/lib/contact_buffers.glsl"
#include "shaders/shared/spatial_hash.h"
#include "shaders/lib/workgroup_scan.glsl"

shared vec3 patchPositions[kSharedPatch];  // relative to patchCentre
shared vec3 patchNormals[kSharedPatch];
shared uint cellStart[kContactWorkgroup];  // candidates before this cell's, in this round
shared uint cellFirst[kContactWorkgroup];  // its first point

vec3 patchCentre = vec3(0.0);  // relative to the HIP, as every place in the step
uint patchCount = 0;
bool patchGathered = false;
bool patchThinned = false;  // some gather of this step took only every so-manyth candidate
uint workDone = 0;

vec3 patchPosition(SpilledPoints spill, uint i) {
  return i < kSharedPatch ? patchPositions[i] : spill.at[2 * (i - kSharedPatch)].xyz;
}
vec3 patchNormal(SpilledPoints spill, uint i) {
  return i < kSharedPatch ? patchNormals[i] : spill.at[2 * (i - kSharedPatch) + 1].xyz;
}

// The last cell of the round whose candidates begin at or before `candidate`; steps written out, since a loop would
// count against the work budget.
uint cellOfCandidate(uint candidate) {
  uint cell = 0;
  if (cellStart[cell + 128] <= candidate) cell += 128;
  if (cellStart[cell + 64] <= candidate) cell += 64;
  if (cellStart[cell + 32] <= candidate) cell += 32;
  if (cellStart[cell + 16] <= candidate) cell += 16;
  if (cellStart[cell + 8] <= candidate) cell += 8;
  if (cellStart[cell + 4] <= candidate) cell += 4;
  if (cellStart[cell + 2] <= candidate) cell += 2;
  if (cellStart[cell + 1] <= candidate) cell += 1;
  return cell;
}

// Fills the patch around `centre`, relative to `hip`. All invocations call it together with the same arguments.
void gatherPatch(CloudView cloud, SpilledPoints spill, vec3 hip, vec3 centre, float reach) {
  const uint kMostInCell = 1u << 22;  // keeps the round's sum of candidates within 32 bits
  const uint lane = scanIndex();
  const float margin = 1.001 * reach;  // hip + centre is rounded
  const ivec3 low = cellOf(cloud.grid, hip + centre - margin);
  const uvec3 size = uvec3(cellOf(cloud.grid, hip + centre + margin) - low + 1);
  const uint cells = cloud.count == 0 ? 0 : min(size.x * size.y * size.z, kPatchMaxCells);
  uint count = 0;
  barrier();  // the last evaluation may still be reading the old patch
  for (uint first = 0; first < cells; first += kContactWorkgroup) {
    uvec2 range = uvec2(0);
    if (first + lane < cells) {
      const uint c = first + lane;
      const ivec3 cell = low + ivec3(c % size.x, c / size.x % size.y, c / (size.x * size.y));
      range = cloud.ranges.at[bucketOf(cloud.grid, cell)];
    }
    uint total;
    cellStart[lane] = workgroupExclusiveScan(min(range.y - range.x, kMostInCell), total);
    cellFirst[lane] = range.x;
    barrier();
    const uint stride = max(1, (total + kPatchRoundCandidates - 1) / kPatchRoundCandidates);
    patchThinned = patchThinned || stride > 1;
    for (uint base = 0; base < total; base += kContactWorkgroup * stride) {
      const uint candidate = base + lane * stride;
      bool keep = false;
      vec3 position;
      uint i = 0;
      if (candidate < total) {
        const uint slot = cellOfCandidate(candidate);
        i = cellFirst[slot] + candidate - cellStart[slot];
        const vec3 absolute = cloud.positions.at[i].xyz;
        position = (absolute - hip) - centre;
        // Another cell of this gather may share the bucket: its points are taken once, when it is that cell's turn.
        const uint c = first + slot;
        const ivec3 cell = low + ivec3(c % size.x, c / size.x % size.y, c / (size.x * size.y));
        keep = cellOf(cloud.grid, absolute) == cell && dot(position, position) < reach * reach;
      }
      uint kept;
      const uint place = count + workgroupExclusiveScan(keep ? 1 : 0, kept);
      if (keep) {
        const vec3 normal = cloud.normals.at[i].xyz;
        if (place < kSharedPatch) {
          patchPositions[place] = position;
          patchNormals[place] = normal;
        } else {
          spill.at[2 * (place - kSharedPatch)] = vec4(position, 0.0);
          spill.at[2 * (place - kSharedPatch) + 1] = vec4(normal, 0.0);
        }
      }
      count += kept;
      workDone += 1 + gl_NumSubgroups;  // the scan loops over the subgroups
    }
    workDone += 1 + gl_NumSubgroups;
    barrier();
  }
  memoryBarrierBuffer();
  barrier();
  patchCentre = centre;
  patchCount = count;
  patchGathered = true;
}

#endif
