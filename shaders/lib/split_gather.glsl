// A first patch that several workgroups gather together: each takes a share of the cells, or of the candidates of one
// round, and the last to finish takes the patch over. No workgroup waits for another, so that it works on drivers that
// run workgroups one after another (the counter is that of the "threadfence reduction" in NVIDIA's CUDA samples).
#ifndef PALPATE_LIB_SPLIT_GATHER_GLSL
#define PALPATE_LIB_SPLIT_GATHER_GLSL

#include "shaders/lib/patch.glsl"

shared bool finishedLast;

// Writes the candidates from `begin` to `end` of the loaded round that belong to the patch, in order, to slots from
// `slot` on.
uint fillSegment(GatheredPatch gathered, CellBox box, uint firstCell, uint stride, uint begin,
                 uint end, uint slot, vec3 hip, vec3 centre, float reach) {
  uint count = 0;
  for (uint base = begin; base < end; base += kContactWorkgroup) {
    const uint k = base + scanIndex();
    Candidate candidate = Candidate(false, 0, vec4(0.0), vec3(0.0));
    if (k < end) candidate = candidateAt(box, firstCell, k * stride, hip, centre, reach);
    uint kept;
    const uint place = slot + count + workgroupExclusiveCount(candidate.kept, kept);
    if (candidate.kept) {
      gathered.points[2 * place] = candidate.place;
      gathered.points[2 * place + 1] = vec4(candidate.normal, 0.0);
    }
    count += kept;
  }
  return count;
}

// Gathers this workgroup's share. The first workgroup also writes the patch's centre.
void gatherShare(GatheredPatch gathered, vec3 hip, vec3 centre, float reach, uint mostCells) {
  const CellBox box = boxAround(hip + centre, reach, mostCells);
  const uint rounds = (box.cells + kContactWorkgroup - 1) / kContactWorkgroup;
  const uint slices = rounds == 0 ? 0 : max(1, gl_NumWorkGroups.x / rounds);
  for (uint share = gl_WorkGroupID.x; share < rounds * slices; share += gl_NumWorkGroups.x) {
    const uint round = share / slices;
    const uint firstCell = round * kContactWorkgroup;
    uint inCell;
    const uint total = loadRound(box, firstCell, inCell);
    const uint stride = strideOf(total, kPatchRoundCandidates);
    const uint taken = takenOf(total, stride);
    const uint each = (taken + slices - 1) / slices;
    const uint begin = min(share % slices * each, taken);
    const uint end = min(begin + each, taken);
    const uint slot = round * kPatchRoundCandidates + begin;
    const uint kept = fillSegment(gathered, box, firstCell, stride, begin, end, slot, hip, centre, reach);
    if (gl_LocalInvocationIndex == 0) {
      gathered.segments[share] = uvec2(slot, kept);
      if (share % slices == 0) atomicAdd(gathered.header.steps, patchSteps(taken));
      if (stride > 1) atomicOr(gathered.header.thinned, 1);
    }
    barrier();
  }
  if (gl_LocalInvocationIndex == 0 && gl_WorkGroupID.x == 0) {
    gathered.header.centre = centre;
    gathered.header.segments = rounds * slices;
  }
}

// Signals that this workgroup has finished. True in the last one to signal, which sees what all have written.
bool finishesLast(GatheredPatch gathered) {
  memoryBarrierBuffer();
  barrier();
  if (gl_LocalInvocationIndex == 0)
    finishedLast = atomicAdd(gathered.header.finished, 1) == gl_NumWorkGroups.x - 1;
  barrier();
  memoryBarrierBuffer();
  return finishedLast;
}

// Resets the header for the next tick, once every invocation has taken the patch.
void clearShares(GatheredPatch gathered) {
  if (gl_LocalInvocationIndex != 0) return;
  gathered.header.finished = 0;
  gathered.header.steps = 0;
  gathered.header.thinned = 0;
}

#endif
