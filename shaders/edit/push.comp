#version 460
#extension GL_GOOGLE_include_directive : require
// Pushing (thesis section 5.2): where the HIP is more than tau behind the proxy, the points in range go a share beta
// of the way to their target each tick. The thesis takes the proxy itself as every point's target, which on flat
// ground only crowds them; here the target is the point's own place on a round tool whose tip stands tau before the
// HIP, so that the tool leaves its shape. With a tool shrunk to a point the two are the same.
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/index.glsl"
#include "shaders/shared/edit.h"

layout(push_constant, scalar) uniform Push { PushArgs args; };

void main() {
  const uint i = threadIndex();
  if (i >= args.count) return;
  const vec3 spring = args.state.at[0].spring;
  const float depth = length(spring);
  if (args.state.at[0].touching == 0 || depth <= args.tau) return;
  const vec3 outward = spring / depth;
  const vec3 center = (args.state.at[0].lastHip + args.tau * outward) + args.toolRadius * outward;

  const vec4 position = args.positions.at[i];
  const vec3 fromCenter = position.xyz - center;
  const float distance = length(fromCenter);
  if (distance >= args.toolRadius) return;
  const vec3 away = distance > 1e-6 * args.toolRadius ? fromCenter / distance : -outward;
  const float move = min(args.beta * (args.toolRadius - distance), args.longestMove);
  args.positions.at[i] = vec4(position.xyz + move * away, position.w);
  args.normals.at[i].w = 1.0;
}
