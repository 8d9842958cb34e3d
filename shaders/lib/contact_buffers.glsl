#ifndef PALPATE_LIB_CONTACT_BUFFERS_GLSL
#define PALPATE_LIB_CONTACT_BUFFERS_GLSL

#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require

layout(buffer_reference) buffer ContactPoses;
layout(buffer_reference) volatile buffer QuestionWords;
layout(buffer_reference) buffer ContactStates;
layout(buffer_reference) buffer ContactSamples;
layout(buffer_reference) coherent buffer GatheredPatch;
layout(buffer_reference) buffer GatherCells;
// Written and read by different invocations of one workgroup.
layout(buffer_reference, scalar, buffer_reference_align = 16) coherent buffer SpilledPoints { vec4 at[]; };

#include "shaders/shared/contact.h"
#include "shaders/shared/gather.h"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ContactPoses {
  QuestionHead head;
  ContactQuestion at[];
};
// The same while the host writes it.
layout(buffer_reference, scalar, buffer_reference_align = 4) volatile buffer QuestionWords {
  QuestionHead head;
  uint at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ContactStates { ContactState at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ContactSamples {
  StepTicks ticks;
  uint words[];  // kSampleWords of each probe
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer GatherCells { GatherCell at[]; };
// Written and read by different workgroups of one dispatch, where the gather is split.
layout(buffer_reference, scalar, buffer_reference_align = 16) coherent buffer GatheredPatch {
  GatherHeader header;
  uvec2 segments[kMaxSegments];
  vec4 points[];
};

#endif
