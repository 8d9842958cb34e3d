#version 460
#extension GL_GOOGLE_include_directive : require
// Runs before a contact step of several workgroups that is submitted ahead of its questions, and waits until the host
// has written them: one for each probe, all of the same tick.
#include "shaders/lib/index.glsl"
#include "shaders/lib/await_question.glsl"

layout(push_constant, scalar) uniform Push { AwaitQuestionArgs args; };

shared uint counting;  // questions that have arrived and were not withdrawn

void main() {
  const uint lastTick = args.question.head.lastTick, most = args.question.head.polls;
  if (gl_LocalInvocationIndex == 0) counting = 0;
  barrier();
  uint tick = 0;
  for (uint probe = gl_SubgroupID, polls = 0; probe < args.probes; probe += gl_NumSubgroups) {
    bool there = false;
    for (; polls < most && !there; ++polls) there = pollQuestion(args.question, probe, lastTick);
    const bool counts = there && awaitedWord(kQuestionWithdrawnAt) == 0;
    tick = counts ? awaitedWord(kQuestionTickAt) : 0;
    if (counts && subgroupElect()) atomicAdd(counting, 1);
    [[unroll]] for (uint k = 0; k < kWordsEach; ++k) {
      const uint place = awaitedPlace(k);
      if (place < kQuestionWords && place != kQuestionTickAt)
        args.taken.at[kQuestionHeadWords + probe * kQuestionWords + place] = awaitedWords[k];
    }
  }
  barrier();
  // All probes are answered, or none is.
  const bool all = counting == args.probes;
  if (subgroupElect())
    for (uint probe = gl_SubgroupID; probe < args.probes; probe += gl_NumSubgroups)
      args.taken.at[kQuestionHeadWords + probe * kQuestionWords + kQuestionTickAt] = all ? tick : 0;
}
