#version 460
#extension GL_GOOGLE_include_directive : require
// The next search direction of a soft body's compliance: along the residual, conjugate to the directions before.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_descent.h"

layout(push_constant, scalar) uniform Push { SoftDescentArgs args; };

#include "shaders/lib/soft_descent.glsl"

void main() {
  const uint node = threadIndex();
  const float left = readRow(kLeftRow + args.round % 2).x;
  const float before = readRow(kLeftRow + (args.round + 1) % 2).x;
  float longest2 = 0;
  if (node < args.nodeCount) {
    const float kept = before > 0 ? left / before : 0;
    vec3 way = args.vectors.at[at(kLeftVector, node)].xyz;
    if (kept > 0) way += kept * args.vectors.at[at(kWayVector, node)].xyz;
    args.vectors.at[at(kWayVector, node)] = vec4(way, 0);
    longest2 = dot(way, way);
  }
  keepRow(kLongestRow, 0, longest2);
}
