// The end of an edit, in its last pass: the workgroup that is done last closes it. Nobody waits for anybody, so that it
// works on drivers that run workgroups one after another (the counter is that of the "threadfence reduction" in
// NVIDIA's CUDA samples).
#ifndef PALPATE_LIB_EDIT_END_GLSL
#define PALPATE_LIB_EDIT_END_GLSL

#include "shaders/lib/edit_buffers.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer SharedWords { uint at[]; };

shared bool finishedLast;

// Says that this workgroup has done its share. True in the one that says it last, which sees what all have written.
bool finishesLast(HashUpdates update) {
  memoryBarrierBuffer();
  barrier();
  if (gl_LocalInvocationIndex == 0)
    finishedLast = atomicAdd(update.at[0].finished, 1) == gl_NumWorkGroups.x * gl_NumWorkGroups.y - 1;
  barrier();
  memoryBarrierBuffer();
  return finishedLast;
}

// One workgroup. Where the report, that of resampling and the empty counters are: see EditEnd.
void endEdit(Uints report, Uints resampled, Uints empty, HashUpdates update, ResampleLists lists) {
  memoryBarrierBuffer();  // other invocations read here what one has written last
  barrier();
  const uint kWord = 4;
  SharedWords counters = SharedWords(uvec2(update)), resampling = SharedWords(uvec2(lists));
  for (uint i = gl_LocalInvocationIndex; i < kUpdateBytes / kWord; i += gl_WorkGroupSize.x) {
    report.at[i] = counters.at[i];
    if (i < kUpdateBegins / kWord) counters.at[i] = empty.at[i];
  }
  if (isNull(resampled)) return;
  for (uint i = gl_LocalInvocationIndex; i < kResamplingBytes / kWord; i += gl_WorkGroupSize.x)
    resampled.at[i] = resampling.at[i];
}

#endif
