#ifndef PALPATE_LIB_CONTACT_BUFFERS_GLSL
#define PALPATE_LIB_CONTACT_BUFFERS_GLSL

#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require

layout(buffer_reference) buffer ContactPoses;
layout(buffer_reference) buffer ContactStates;
layout(buffer_reference) buffer ContactSamples;
// Written and read by different invocations of one workgroup.
layout(buffer_reference, scalar, buffer_reference_align = 16) coherent buffer SpilledPoints { vec4 at[]; };

#include "shaders/shared/contact.h"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ContactPoses { ContactPose at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ContactStates { ContactState at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ContactSamples { ContactSample at[]; };

#endif
