#version 460
#extension GL_GOOGLE_include_directive : require
// Moves particles, and the balls of tools, by their own velocity in a substep, and estimates the particles'
// displacement from their listed positions by the time when lists can be made again.
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterPredictArgs args; };

#include "shaders/lib/matter_setting.glsl"
#include "shaders/lib/matter_hands.glsl"
#include "shaders/lib/matter_model.glsl"

// The ball does not enter the model in the matter.
void stopTool(uint t) {
  if (!hasModel()) return;
  const vec3 velocity = args.tools.at[t].velocity, place = args.tools.at[t].place;
  const float radius = min(SETTING.ballRadius, args.tools.at[t].grown);
  const StoppedBall stopped = stoppedBall(modelAbout(place), radius, velocity);
  args.tools.at[t].lag += stopped.move;
  args.tools.at[t].place = place + stopped.move;
  args.tools.at[t].velocity = velocity + stopped.change;
  args.tools.at[t].modelImpulse += SETTING.spring.mass * stopped.change;
}

shared uint farthest;  // of the workgroup

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
    atomicMax(farthest, floatBitsToUint(dot(gone, gone)));  // bits of non-negative floats grow like the floats
  }
  barrier();
  if (gl_LocalInvocationIndex == 0) atomicMax(args.control.now.farthest, farthest);
  if (i >= args.toolCount) return;
  predictTool(i, args.substep);
  stopTool(i);
}
