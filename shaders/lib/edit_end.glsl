// The end of an edit, in its last pass: the workgroup that finishes last closes it. No workgroup waits for another, so
// that it works on drivers that run workgroups one after another (the counter is that of the "threadfence reduction" in
// NVIDIA's CUDA samples).
#ifndef PALPATE_LIB_EDIT_END_GLSL
#define PALPATE_LIB_EDIT_END_GLSL

#include "shaders/lib/edit_buffers.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer SharedWords { uint at[]; };

shared bool finishedLast;

// Signals that this workgroup has finished. True in the last one to signal, which sees what all have written.
bool finishesLast(HashUpdates update) {
  memoryBarrierBuffer();
  barrier();
  if (gl_LocalInvocationIndex == 0)
    finishedLast = atomicAdd(update.at[0].finished, 1) == gl_NumWorkGroups.x * gl_NumWorkGroups.y - 1;
  barrier();
  memoryBarrierBuffer();
  return finishedLast;
}

// One workgroup. For the report, that of resampling and the empty counters see EditEnd.
void endEdit(Uints report, Uints resampled, Uints empty, HashUpdates update, ResampleLists lists) {
  memoryBarrierBuffer();  // other invocations read here what one has just written
  barrier();
  const uint kWord = 4;
  SharedWords counters = SharedWords(uvec2(update)), resampling = SharedWords(uvec2(lists));
  for (uint i = gl_LocalInvocationIndex; i < kUpdateBytes / kWord; i += gl_WorkGroupSize.x) {
    report.at[i] = counters.at[i];
    if (i < kUpdateBegins / kWord || i >= kUpdateSeen / kWord) counters.at[i] = empty.at[i];
  }
  if (isNull(resampled)) return;
  for (uint i = gl_LocalInvocationIndex; i < kResamplingBytes / kWord; i += gl_WorkGroupSize.x)
    resampled.at[i] = resampling.at[i];
}

#endif
