#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_realtime_clock : require
// Reads the clock that watched invocations read (WorkgroupWatch), which has no unit of its own.
#include "shaders/shared/types.h"

layout(local_size_x_id = 0) in;
layout(push_constant, scalar) uniform Push { Uints ticks; };

void main() {
  if (gl_GlobalInvocationID.x != 0) return;
  const uvec2 now = clockRealtime2x32EXT();
  ticks.at[0] = now.x;
  ticks.at[1] = now.y;
}
