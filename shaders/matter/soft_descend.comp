#version 460
#extension GL_GOOGLE_include_directive : require
// Takes the optimal step along the search direction, and updates the residual of the load. Where the body would buckle
// along it, the residual becomes 0, which ends the search.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_descent.h"

layout(push_constant, scalar) uniform Push { SoftDescentArgs args; };

#include "shaders/lib/soft_descent.glsl"

void main() {
  const uint node = threadIndex();
  float far = 0;
  if (args.begins == 0) {
    const float left = readRow(kLeftRow + args.round % 2).x, answered = readRow(kAnswerRow).x;
    far = answered > 0 ? left / answered : 0;
  }
  float leftNow = 0, moved = 0;
  if (node < args.nodeCount) {
    const vec3 load = args.load.at[node].xyz;
    vec3 left = load, way = vec3(0);
    if (args.begins == 0) {
      if (far > 0)
        left = args.vectors.at[at(kLeftVector, node)].xyz - far * args.vectors.at[at(kAnswerVector, node)].xyz;
      else
        left = vec3(0);
      way = args.vectors.at[at(kMovedVector, node)].xyz + far * args.vectors.at[at(kWayVector, node)].xyz;
    }
    args.vectors.at[at(kLeftVector, node)] = vec4(left, 0);
    args.vectors.at[at(kMovedVector, node)] = vec4(way, 0);
    leftNow = dot(left, left);
    moved = dot(load, way);
  }
  keepRow(kLeftRow + (args.round + 1) % 2, leftNow, 0);
  keepRow(kMovedRow, moved, 0);
}
