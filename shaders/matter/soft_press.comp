#version 460
#extension GL_GOOGLE_include_directive : require
// Hands that press on a soft body, in a substep: a spring and a damper each, implicit with respect to the effect of
// cells and other presses on the position; one press after another, starting from the forces before (Gauss and Seidel;
// engine/matter/soft_press.hpp).
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_press.h"

layout(push_constant, scalar) uniform Push { SoftPressArgs args; };

#include "shaders/lib/matter_sums.glsl"
#include "shaders/lib/soft_forces.glsl"

shared vec3 forces[kMaxPresses];  // on the hands, N
shared vec3 change;                // of one of these forces

// Velocity that the position of a press would have at the end of the substep without any press: a partial sum, over the
// nodes of this invocation.
vec3 freeVelocity(uint press) {
  const float step = args.setting.now.step;
  vec3 velocity = vec3(0);
  const uint row = args.presses.at[press].row;
  for (uint k = gl_LocalInvocationIndex; k < args.counts.at[1 + row]; k += kMatterBlock) {
    const uint at = row * args.heldStride + k, node = args.held.at[at].node;
    const vec4 before = args.nodes.at[kNodeVec4s * node + 1];
    if (before.w == 0) continue;
    const float mass = args.nodes.at[kNodeVec4s * node].w;
    velocity += args.held.at[at].share * (before.xyz + (step / mass * forceOn(node) + args.setting.now.fall));
  }
  return velocity;
}

float coupled(uint press, uint other) { return args.coupling.at[press * kMaxPresses + other]; }

vec3 forceOnHand(uint press, vec3 velocity, vec3 before) {
  const float step = args.setting.now.step;
  const float stiffness = args.presses.at[press].stiffness, damping = args.presses.at[press].damping;
  const vec3 stretch = args.presses.at[press].stretch + args.done.at[press].moved + step * velocity -
                       args.share * args.presses.at[press].move;
  const vec3 apart = velocity - args.presses.at[press].velocity;
  const float answered = step * (stiffness * step + damping) * coupled(press, press);
  const vec3 force = (stiffness * stretch + damping * apart + answered * before) / (1 + answered);
  const vec3 normal = args.presses.at[press].normal;
  const float push = dot(force, normal);
  if (!(push > 0)) return vec3(0);
  const vec3 along = force - push * normal;
  const float drag = length(along), most = args.presses.at[press].friction * push;
  return push * normal + (drag > most ? most / drag : 1) * along;
}

// Factor on a press's force that limits the sum of the presses of its hand to the hand's maximum.
float bornBy(uint press, uint presses) {
  const uint hand = args.presses.at[press].hand;
  uint first = press, end = press + 1;
  while (first > 0 && args.presses.at[first - 1].hand == hand) --first;
  while (end < presses && args.presses.at[end].hand == hand) ++end;
  vec3 sum = vec3(0);
  for (uint k = first; k < end; ++k) sum += forces[k];
  const float size = length(sum), most = args.presses.at[first].most;
  return size > most ? most / size : 1;
}

vec3 slowedBy(uint press, uint presses) {
  vec3 slowed = vec3(0);
  for (uint k = 0; k < presses; ++k) slowed += coupled(press, k) * forces[k];
  return args.setting.now.step * slowed;
}

void report(uint press, vec3 force, vec3 velocity) {
  const float step = args.setting.now.step;
  args.done.at[press].force = force;
  args.done.at[press].impulse += step * force;
  args.done.at[press].work -= args.perStep * dot(force, args.presses.at[press].move);
  args.done.at[press].moved += step * velocity;
}

void pushNodes(uint press) {
  const vec3 impulse = args.setting.now.step * forces[press];
  const uint row = args.presses.at[press].row;
  for (uint k = gl_LocalInvocationIndex; k < args.counts.at[1 + row]; k += kMatterBlock) {
    const uint at = row * args.heldStride + k, node = args.held.at[at].node;
    const vec4 before = args.nodes.at[kNodeVec4s * node + 1];
    if (before.w == 0) continue;
    const vec3 slowed = args.held.at[at].share / args.nodes.at[kNodeVec4s * node].w * impulse;
    args.nodes.at[kNodeVec4s * node + 1] = vec4(before.xyz - slowed, before.w);
  }
}

void main() {
  const uint local = gl_LocalInvocationIndex, presses = args.counts.at[0];
  const bool isPress = local < presses;
  vec3 freely = vec3(0);
  for (uint press = 0; press < presses; press += 2) {
    vec4 one = vec4(freeVelocity(press), 0);
    vec4 other = press + 1 < presses ? vec4(freeVelocity(press + 1), 0) : vec4(0);
    addUp(one, other, false);
    if (local == press) freely = one.xyz;
    if (local == press + 1) freely = other.xyz;
  }
  if (isPress) forces[local] = args.done.at[local].force;
  barrier();
  vec3 velocity = freely;
  if (isPress) velocity -= slowedBy(local, presses);
  barrier();  // all have read the previous forces
  for (uint press = 0; press < presses; ++press) {
    if (local == press) {
      const vec3 force = forceOnHand(press, velocity, forces[press]);
      change = force - forces[press];
      forces[press] = force;
    }
    barrier();
    if (isPress) velocity -= args.setting.now.step * coupled(local, press) * change;
    barrier();
  }
  const float born = isPress ? bornBy(local, presses) : 1;
  barrier();
  if (isPress) forces[local] *= born;
  barrier();
  if (isPress) report(local, forces[local], freely - slowedBy(local, presses));
  for (uint press = 0; press < presses; ++press) {
    pushNodes(press);
    memoryBarrierBuffer();
    barrier();
  }
}
