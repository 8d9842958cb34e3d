// Waits until the host has written the question of a probe. A subgroup reads all words of it at once; they may arrive
// in any order, and the seal tells when they are complete.
#ifndef PALPATE_LIB_AWAIT_QUESTION_GLSL
#define PALPATE_LIB_AWAIT_QUESTION_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/subgroup_reduce.glsl"

const uint kSmallestSubgroup = 4;
const uint kWordsEach = (kQuestionWords + kSmallestSubgroup - 1) / kSmallestSubgroup;

uint awaitedWords[kWordsEach];  // number gl_SubgroupInvocationID and on, in steps of gl_SubgroupSize
uint awaitedPlace(uint k) { return k * gl_SubgroupSize + gl_SubgroupInvocationID; }

uint awaitedWord(uint place) {
  uint word = 0;
  [[unroll]] for (uint k = 0; k < kWordsEach; ++k) word += awaitedPlace(k) == place ? awaitedWords[k] : 0;
  return reduceAdd(word);
}

// Whether a question of that probe other than the last one has arrived. The whole subgroup calls it together.
bool pollQuestion(QuestionWords question, uint probe, uint lastTick) {
  uint missing = 0;  // what the words do not sum up to
  bool newer = false;
  [[unroll]] for (uint k = 0; k < kWordsEach; ++k) {
    const uint place = awaitedPlace(k);
    awaitedWords[k] = place < kQuestionWords ? question.at[probe * kQuestionWords + place] : 0;
    if (place < kQuestionSealAt) missing += questionShare(awaitedWords[k], place);
    if (place == kQuestionSealAt) missing -= awaitedWords[k];
    newer = newer || (place == kQuestionTickAt && awaitedWords[k] != lastTick);
  }
  return reduceAdd(missing) == 0 && subgroupAny(newer);
}

#endif
