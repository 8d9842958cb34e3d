#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_KHR_shader_subgroup_vote : require
// One primitive at a time, by the functions that all passes use, with results that the host knows (engine/proof). An
// invocation is numbered by scanIndex() within its workgroup.
#include "shaders/lib/index.glsl"
#include "shaders/lib/subgroup_meet.glsl"
#include "shaders/lib/subgroup_sum.glsl"
#include "shaders/lib/workgroup_scan.glsl"
#include "shaders/shared/proof.h"

layout(push_constant, scalar) uniform Push { ProofArgs args; };
layout(constant_id = 1) const uint kPrimitive = kProofSum;
layout(constant_id = 2) const bool kWrong = false;  // for tests: the primitive fails

layout(buffer_reference, scalar, buffer_reference_align = 8) coherent buffer PassedWords { uint at[]; };

shared uint passed[kProofWorkgroup], added;

uint place() { return workgroupIndex() * kProofWorkgroup + scanIndex(); }
uint own() { return args.values.at[place()]; }
void give(uint word, uint result) { args.results.at[place() * kProofWords + word] = result; }

void sum() {
  const uint value = kWrong && gl_SubgroupInvocationID == gl_SubgroupSize - 1 ? 0 : own();
  uint total;
  give(0, workgroupExclusiveScan(value, total));
  give(1, total);
  give(2, uint(subgroupSum(vec4(value % 1000, 1, 2, 3)).x));
  give(3, reduceMin(value) ^ reduceMax(value));
}

void ballot() {
  const uint value = own();
  const bool first = (value & 1) != 0 && !(kWrong && gl_SubgroupInvocationID == 1), second = (value & 2) != 0;
  uint total, both;
  give(0, workgroupExclusiveCount(first, total));
  give(1, total);
  const uvec2 places = workgroupExclusiveCounts(first, second, both);
  give(2, places.x + (places.y << 16));
  give(3, subgroupBallotFindLSB(subgroupBallot(value % 3 == 0)) + (subgroupAny(value % 64 == 0) ? 256 : 0) +
              (subgroupAll(value % 64 != 1) ? 512 : 0));
}

void shuffle() {
  const uint value = own(), lane = gl_SubgroupInvocationID, size = gl_SubgroupSize;
  give(0, subgroupShuffle(value, (lane * 5 + (kWrong ? 2 : 3)) % size));
  give(1, subgroupShuffleXor(value, size / 2));
  give(2, subgroupBroadcastFirst(value));
  give(3, subgroupShuffle(value, size - 1 - lane));
}

// Values pass through shared memory to the whole workgroup, and through a buffer to the subgroup.
void pass() {
  const uint here = scanIndex(), from = (here + kProofStride) % kProofWorkgroup;
  uint value = own();
  passed[here] = 0;
  barrier();
  for (uint round = 0; round < kProofRounds; ++round) {
    passed[here] = value + round;
    if (!kWrong) barrier();
    value = 3 * value + passed[from];
    barrier();
  }
  give(0, value);
  const uint first = place() - gl_SubgroupInvocationID;
  PassedWords words = PassedWords(uvec2(args.others));
  // Some subgroups meet more often than others.
  const uint rounds = kProofRounds + gl_SubgroupID % 3;
  for (uint round = 0; round < rounds; ++round) {
    words.at[place()] = value;
    subgroupMemoryBarrierBuffer();
    subgroupMeet();
    value = 3 * value + words.at[first + (gl_SubgroupInvocationID + 1) % gl_SubgroupSize];
    subgroupMemoryBarrierBuffer();
    subgroupMeet();
  }
  give(1, value);
  give(2, gl_SubgroupSize);
  give(3, gl_NumSubgroups);
}

void count() {
  const uint value = own();
  if (gl_LocalInvocationIndex == 0) added = 0;
  barrier();
  atomicAdd(added, value & 15);
  barrier();
  uint ticket = 0;
  if (kWrong) {
    ticket = args.counters.at[0];
    args.counters.at[0] = ticket + 1;
  } else {
    ticket = atomicAdd(args.counters.at[0], 1);
  }
  atomicMin(args.counters.at[1], value);
  atomicMax(args.counters.at[2], value);
  atomicOr(args.counters.at[3], 1u << value % 32);
  atomicAdd(args.others.at[ticket], 1);
  give(0, added);
  give(1, atomicCompSwap(args.counters.at[4], 0, 1) == 0 ? 1 : 0);
  give(2, 0);
  give(3, 0);
}

void main() {
  if (kPrimitive == kProofSum) sum();
  if (kPrimitive == kProofBallot) ballot();
  if (kPrimitive == kProofShuffle) shuffle();
  if (kPrimitive == kProofBarrier) pass();
  if (kPrimitive == kProofAtomic) count();
  // For tests: the first value that the GPU has seen, as from a cache that the host's write does not reach.
  if (kPrimitive == kProofHostWrite) {
    const uint seen = atomicCompSwap(args.others.at[place()], 0, own());
    const uint value = kWrong && seen != 0 ? seen : own();
    for (uint word = 0; word < kProofWords; ++word) give(word, value * (word + 1));
  }
  // Workgroups of the pass that follows, as many as there are odd values in the first workgroup's.
  if (kPrimitive == kProofCount && workgroupIndex() == 0) {
    uint total;
    workgroupExclusiveCount((own() & 1) != 0, total);
    if (gl_LocalInvocationIndex < 3)
      args.counters.at[gl_LocalInvocationIndex] = gl_LocalInvocationIndex > 0 ? 1 : kWrong ? total - 1 : total;
  }
  if (kPrimitive == kProofCounted && gl_LocalInvocationIndex == 0) args.others.at[workgroupIndex()] += 1;
  // For tests: two pairs change places.
  if (kPrimitive == kProofSpoil && threadIndex() == 0) {
    const uint first = args.others.at[0];
    args.others.at[0] = args.others.at[1];
    args.others.at[1] = first;
  }
}
