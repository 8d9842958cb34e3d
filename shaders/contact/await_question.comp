#version 460
#extension GL_GOOGLE_include_directive : require
// Runs before a contact step that is submitted ahead of its questions, and waits until the host has written them: one
// for each probe, all of the same tick. A subgroup reads all words of a question at once; they may arrive in any order,
// and the seal tells when they are complete.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/index.glsl"
#include "shaders/lib/contact_buffers.glsl"

layout(push_constant, scalar) uniform Push { AwaitQuestionArgs args; };

const uint kSmallestSubgroup = 4;
const uint kWordsEach = (kQuestionWords + kSmallestSubgroup - 1) / kSmallestSubgroup;

shared uint counting;  // questions that have arrived and were not withdrawn

uint words[kWordsEach];  // number gl_SubgroupInvocationID and on, in steps of gl_SubgroupSize
uint placeOf(uint k) { return k * gl_SubgroupSize + gl_SubgroupInvocationID; }

uint wordAt(uint place) {
  uint word = 0;
  [[unroll]] for (uint k = 0; k < kWordsEach; ++k) word += placeOf(k) == place ? words[k] : 0;
  return subgroupAdd(word);
}

// Whether a question of that probe other than the last one has arrived.
bool poll(uint probe, uint lastTick) {
  uint share = 0;
  [[unroll]] for (uint k = 0; k < kWordsEach; ++k) {
    words[k] = placeOf(k) < kQuestionWords ? args.question.at[probe * kQuestionWords + placeOf(k)] : 0;
    if (placeOf(k) < kQuestionSealAt) share += questionShare(words[k], placeOf(k));
  }
  return subgroupAdd(share) == wordAt(kQuestionSealAt) && wordAt(kQuestionTickAt) != lastTick;
}

void main() {
  const uint lastTick = args.lastTick.at[0];
  if (gl_LocalInvocationIndex == 0) counting = 0;
  barrier();
  uint tick = 0;
  for (uint probe = gl_SubgroupID, polls = 0; probe < args.probes; probe += gl_NumSubgroups) {
    bool there = false;
    for (; polls < args.polls && !there; ++polls) there = poll(probe, lastTick);
    const bool counts = there && wordAt(kQuestionWithdrawnAt) == 0;
    tick = counts ? wordAt(kQuestionTickAt) : 0;
    if (counts && subgroupElect()) atomicAdd(counting, 1);
    [[unroll]] for (uint k = 0; k < kWordsEach; ++k)
      if (placeOf(k) < kQuestionWords && placeOf(k) != kQuestionTickAt)
        args.taken.at[probe * kQuestionWords + placeOf(k)] = words[k];
  }
  barrier();
  // All probes are answered, or none is.
  const bool all = counting == args.probes;
  if (subgroupElect())
    for (uint probe = gl_SubgroupID; probe < args.probes; probe += gl_NumSubgroups)
      args.taken.at[probe * kQuestionWords + kQuestionTickAt] = all ? tick : 0;
}
