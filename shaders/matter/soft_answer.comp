#version 460
#extension GL_GOOGLE_include_directive : require
// Response of a soft body to a search direction: central difference of the forces of its cells and the walls over a
// trial.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_descent.h"

layout(push_constant, scalar) uniform Push { SoftDescentArgs args; };

#include "shaders/lib/soft_descent.glsl"
#include "shaders/lib/soft_forces.glsl"

void main() {
  const uint node = threadIndex();
  const float scale = trialScale();
  const bool ends = args.sign < 0;
  float done = 0;
  if (node < args.nodeCount) {
    const vec3 way = args.vectors.at[at(kWayVector, node)].xyz;
    vec3 answer = vec3(0);
    if (isFree(node)) {
      if (ends) answer = args.vectors.at[at(kAnswerVector, node)].xyz;
      answer -= args.sign / (2 * scale) * forceOn(node);
      if (ends) answer += args.hold * args.nodes.at[kNodeVec4s * node].w * way;
    }
    args.vectors.at[at(kAnswerVector, node)] = vec4(answer, 0);
    done = dot(way, answer);
  }
  if (ends) keepRow(kAnswerRow, done, 0);
}
