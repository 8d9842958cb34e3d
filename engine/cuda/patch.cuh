// The patch of points around the probe: gathered through the spatial hash by one block, as in shaders/lib/patch.glsl,
// or taken over from slots filled by other kernels. Its order depends only on the hash.
#pragma once

#include "engine/cuda/gather_plan.cuh"

namespace palpate::cu {

/// The part of a patch that one block keeps in shared memory.
struct SharedPatch {
  float3 positions[kMaxSharedPatch];  // relative to the patch's centre
  float3 normals[kMaxSharedPatch];
  uint cellStart[kStepThreads];  // number of candidates before this cell, in this round
  uint cellFirst[kStepThreads];  // first point of the cell
};

class Patch {
 public:
  __device__ Patch(const StepArgs& args, const CloudView& cloud, SharedPatch& memory, const vec3& hip)
      : cloud_(cloud), memory_(memory), spill_(reinterpret_cast<float4*>(args.spill)), hip_(hip) {}

  __device__ uint count() const { return count_; }
  __device__ bool gathered() const { return gathered_; }
  __device__ bool thinned() const { return thinned_; }
  __device__ const vec3& centre() const { return centre_; }  ///< relative to the HIP
  __device__ vec3 position(uint i) const {
    if (i >= kMaxSharedPatch) return xyz(spill_[2 * (i - kMaxSharedPatch)]);
    const float3 p = memory_.positions[i];
    return {p.x, p.y, p.z};
  }
  __device__ vec3 normal(uint i) const {
    if (i >= kMaxSharedPatch) return xyz(spill_[2 * (i - kMaxSharedPatch) + 1]);
    const float3 n = memory_.normals[i];
    return {n.x, n.y, n.z};
  }

  /// Fills the patch around `centre`, relative to the HIP. All threads must call it together with the same arguments.
  __device__ void gatherAround(const vec3& centre, float reach) {
    const CellBox box = boxAround(cloud_, hip_, centre, reach);
    begin(centre);
    for (uint first = 0; first < box.cells; first += kStepThreads) {
      const uint2 range = rangeOfCell(cloud_, box, first + threadIdx.x);
      uint total;
      memory_.cellStart[threadIdx.x] = blockExclusiveScan(candidatesIn(range), total);
      memory_.cellFirst[threadIdx.x] = range.x;
      __syncthreads();
      const uint stride = strideFor(total);
      thinned_ = thinned_ || stride > 1;
      for (uint base = 0; base < total; base += kStepThreads * stride) {
        const uint candidate = base + threadIdx.x * stride;
        bool keep = false;
        vec3 relative(0.0f);
        uint i = 0;
        if (candidate < total) {
          const uint slot = cellOfCandidate(candidate);
          i = memory_.cellFirst[slot] + candidate - memory_.cellStart[slot];
          const vec3 absolute = xyz(loadPoint(cloud_.positions, i));
          relative = (absolute - hip_) - centre;
          keep = inReach(cloud_, absolute, cellAt(box, first + slot), relative, reach);
        }
        append(keep, relative, keep ? xyz(loadPoint(cloud_.normals, i)) : vec3(0.0f));
      }
      __syncthreads();  // the next round overwrites the cells
    }
    end();
  }

  /// Takes over the points in the slots, written by the gather's kernels.
  __device__ void takeOver(const Gather& gather, const vec4* slots) {
    begin(gather.centre);
    thinned_ = gather.thinned != 0;
    for (uint base = 0; base < gather.slots; base += kStepThreads) {
      const uint slot = base + threadIdx.x;
      float4 found = make_float4(0, 0, 0, 0);
      if (slot < gather.slots) found = reinterpret_cast<const float4*>(slots)[2 * slot];
      const bool keep = found.w != 0.0f;
      append(keep, xyz(found), keep ? xyz(reinterpret_cast<const float4*>(slots)[2 * slot + 1]) : vec3(0.0f));
    }
    end();
  }

 private:
  __device__ void begin(const vec3& centre) {
    __syncthreads();  // the last evaluation may still be reading the old patch
    centre_ = centre;
    count_ = 0;
  }
  __device__ void end() {
    __syncthreads();
    gathered_ = true;
  }
  __device__ void append(bool keep, const vec3& position, const vec3& normal) {
    uint kept;
    const uint place = count_ + blockExclusiveScan(keep ? 1 : 0, kept);
    if (keep && place < kMaxSharedPatch) {
      memory_.positions[place] = make_float3(position.x, position.y, position.z);
      memory_.normals[place] = make_float3(normal.x, normal.y, normal.z);
    } else if (keep) {
      spill_[2 * (place - kMaxSharedPatch)] = make_float4(position.x, position.y, position.z, 0);
      spill_[2 * (place - kMaxSharedPatch) + 1] = make_float4(normal.x, normal.y, normal.z, 0);
    }
    count_ += kept;
  }
  // The last cell of the round whose candidates begin at or before `candidate`.
  __device__ uint cellOfCandidate(uint candidate) const {
    uint cell = 0;
    for (uint step = kStepThreads / 2; step > 0; step /= 2)
      if (memory_.cellStart[cell + step] <= candidate) cell += step;
    return cell;
  }

  const CloudView& cloud_;
  SharedPatch& memory_;
  float4* spill_;
  vec3 hip_;
  vec3 centre_{0.0f};
  uint count_ = 0;
  bool gathered_ = false, thinned_ = false;
};

}  // namespace palpate::cu
