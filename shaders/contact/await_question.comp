#version 460
#extension GL_GOOGLE_include_directive : require
// Stands before a contact step that is submitted ahead of its question, and waits until the host has written that. One
// subgroup looks at all words at once; they may arrive in any order, and the seal tells when they are whole.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/index.glsl"
#include "shaders/lib/contact_buffers.glsl"

layout(push_constant, scalar) uniform Push { AwaitQuestionArgs args; };

const uint kSmallestSubgroup = 4;
const uint kWordsEach = (kQuestionWords + kSmallestSubgroup - 1) / kSmallestSubgroup;

uint words[kWordsEach];  // numbers gl_SubgroupInvocationID, and on in steps of gl_SubgroupSize
uint placeOf(uint k) { return k * gl_SubgroupSize + gl_SubgroupInvocationID; }

uint wordAt(uint place) {
  uint word = 0;
  [[unroll]] for (uint k = 0; k < kWordsEach; ++k) word += placeOf(k) == place ? words[k] : 0;
  return subgroupAdd(word);
}

// Whether there is a question other than the last one.
bool look(uint lastTick) {
  uint share = 0;
  [[unroll]] for (uint k = 0; k < kWordsEach; ++k) {
    words[k] = placeOf(k) < kQuestionWords ? args.question.at[placeOf(k)] : 0;
    if (placeOf(k) < kQuestionSealAt) share += questionShare(words[k], placeOf(k));
  }
  return subgroupAdd(share) == wordAt(kQuestionSealAt) && wordAt(kQuestionTickAt) != lastTick;
}

void main() {
  if (gl_SubgroupID != 0) return;
  const uint lastTick = args.lastTick.at[0];
  bool there = false;
  for (uint looks = 0; looks < args.looks && !there; ++looks) there = look(lastTick);
  const bool counts = there && wordAt(kQuestionWithdrawnAt) == 0;
  [[unroll]] for (uint k = 0; k < kWordsEach; ++k)
    if (placeOf(k) < kQuestionWords) args.taken.at[placeOf(k)] = counts || placeOf(k) != kQuestionTickAt ? words[k] : 0;
}
