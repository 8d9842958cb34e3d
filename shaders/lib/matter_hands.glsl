// Effect of hands on the balls of tools. Requires `args` with setting, hands, tools and toolCount.
#ifndef PALPATE_LIB_MATTER_HANDS_GLSL
#define PALPATE_LIB_MATTER_HANDS_GLSL
#include "shaders/lib/matter_tools.glsl"

// A substep without other forces, towards a hand that moves meanwhile.
void predictTool(uint t, uint substep) {
  const ToolSpring spring = toolSpring();
  const uint at = substep * args.toolCount + t;
  const bool begins = substep == 0;
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
  args.tools.at[t].grown = args.hands.at[at].grown;
  args.tools.at[t].springImpulse = (begins ? vec3(0) : args.tools.at[t].springImpulse) + impulse;
  args.tools.at[t].portWork = (begins ? 0 : args.tools.at[t].portWork) + dot(impulse / spring.step, move);
  if (!begins) return;
  args.tools.at[t].impulse = vec3(0);
  args.tools.at[t].angular = vec3(0);
  args.tools.at[t].modelImpulse = vec3(0);
}

#endif
