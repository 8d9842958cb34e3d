#version 460
#extension GL_GOOGLE_include_directive : require
// Where particles, and the balls of tools, go by themselves in a substep, and how far particles will have gone from where
// they were listed once lists can be made again, as far as can be seen now.
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterPredictArgs args; };

#include "shaders/lib/matter_setting.glsl"

shared uint farthest;  // of the workgroup

void predictTool(uint t) {
  const ToolSpring spring =
      ToolSpring(SETTING.spring.mass, SETTING.spring.stiffness, SETTING.spring.damping, SETTING.spring.step);
  const uint at = args.substep * args.toolCount + t;
  const bool begins = args.substep == 0;
  const vec3 move = args.hands.at[at].move, before = args.tools.at[t].velocity, lag = args.tools.at[t].lag;
  const vec3 velocity = velocityOnSpring(spring, before, move - lag, move);
  const vec3 newLag = lag - move + spring.step * velocity, impulse = spring.mass * (velocity - before);
  args.tools.at[t].lag = newLag;
  args.tools.at[t].place = args.hands.at[at].place + newLag;
  args.tools.at[t].velocity = velocity;
  args.tools.at[t].spin = args.hands.at[at].spin;
  args.tools.at[t].x = args.hands.at[at].x;
  args.tools.at[t].y = args.hands.at[at].y;
  args.tools.at[t].z = args.hands.at[at].z;
  args.tools.at[t].springImpulse = (begins ? vec3(0) : args.tools.at[t].springImpulse) + impulse;
  args.tools.at[t].portWork = (begins ? 0 : args.tools.at[t].portWork) + dot(impulse / spring.step, move);
  if (!begins) return;
  args.tools.at[t].impulse = vec3(0);
  args.tools.at[t].angular = vec3(0);
}

void main() {
  if (args.control.now.state != kMatterRunning) return;
  const uint i = threadIndex();
  for (uint cell = i; cell < args.counts; cell += args.threads) args.firsts.at[cell] = 0;
  if (gl_LocalInvocationIndex == 0) farthest = 0;
  barrier();
  if (i < args.particles) {
    const vec3 velocity = args.velocities.at[args.control.now.parity * args.particles + i].xyz + SETTING.fall;
    const vec3 place = args.positions.at[i].xyz + SETTING.step * velocity;
    args.places.at[i] = vec4(place, 0);
    const vec3 moved = place + (args.ahead * SETTING.step) * velocity - args.listedAt.at[i].xyz;
    const vec3 gone = args.ahead > 0 ? kForesight * moved : moved;
    atomicMax(farthest, floatBitsToUint(dot(gone, gone)));  // bits grow as floats do that are not below 0
  }
  barrier();
  if (gl_LocalInvocationIndex == 0) atomicMax(args.control.now.farthest, farthest);
  if (i < args.toolCount) predictTool(i);
}
