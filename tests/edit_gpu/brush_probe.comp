#version 460
#extension GL_GOOGLE_include_directive : require
// Evaluates shaders/shared/brush.h on the GPU.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
layout(buffer_reference) buffer BrushQuestions;
layout(buffer_reference) buffer BrushAnswers;
#include "tests/edit_gpu/brush_probe.h"
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer BrushQuestions { BrushQuestion at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer BrushAnswers { BrushAnswer at[]; };
#include "shaders/lib/index.glsl"

layout(push_constant, scalar) uniform Push { BrushProbeArgs args; };

void main() {
  const uint i = threadIndex();
  if (i < args.count) args.answers.at[i] = answerTo(args.questions.at[i], args.signedDistance);
}
