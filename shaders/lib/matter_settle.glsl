// The end of a pass that moves particles: what tools do to a particle and it to them, and where it is then. Whoever
// includes this has `args` with what these need, and meetPoint() calls noteExchange(). All invocations of a workgroup
// of kMatterBlock call the functions together.
#ifndef PALPATE_LIB_MATTER_SETTLE_GLSL
#define PALPATE_LIB_MATTER_SETTLE_GLSL

// Of this invocation's particle by the tool at hand: the change of its velocity, and with it the tool's angular one.
vec3 toolChange, toolTurn;
uint toolAtHand;
shared uint meetsTool;  // whether any of the workgroup's particles is near

void noteExchange(vec3 change, vec3 arm) {
  toolChange += change;
  toolTurn += cross(arm, change);
}

// Of a slot as predicted, with what gravity has added.
vec3 velocityOf(uint slot) {
  return args.velocities.at[args.control.now.parity * args.particles + slot].xyz + SETTING.fall;
}

vec3 changeByTools(bool isParticle, vec3 place) {
  const uint block = workgroupIndex();
  vec3 change = vec3(0);
  for (uint tool = 0; tool < args.toolCount; ++tool) {
    const BodyPose pose = poseOf(tool);
    const bool meets = isParticle && isNear(pose, place);
    if (gl_LocalInvocationIndex == 0) meetsTool = 0;
    barrier();
    if (meets) atomicOr(meetsTool, 1);
    barrier();
    const uint row = (kRowsOfAll + 2 * tool) * args.blocks + block;
    vec4 impulse = vec4(0), angular = vec4(0);
    if (meetsTool != 0) {
      toolChange = toolTurn = vec3(0);
      toolAtHand = tool;
      if (meets) {
        meetPoints(pose, place);
        const vec3 outwards = pushedOut(pose, place, SETTING.bodyKept, SETTING.bodyPush, SETTING.step);
        noteExchange(outwards, place - pose.place);
      }
      change += toolChange;
      impulse.xyz = -SETTING.mass * toolChange;
      angular.xyz = -SETTING.mass * toolTurn;
      addUp(impulse, angular, false);
    }
    if (gl_LocalInvocationIndex == 0) {
      args.sums.at[row] = impulse;
      args.sums.at[row + args.blocks] = angular;
    }
    barrier();
  }
  return change;
}

// What the model got from a particle, row by row over the blocks.
void noteModel(vec3 change, vec3 place) {
  const uint block = workgroupIndex(), row = (kRowsOfAll + 2 * args.toolCount) * args.blocks + block;
  const vec3 given = -SETTING.mass * change;
  vec4 impulse = vec4(given, 0), angular = vec4(cross(place - SETTING.modelMiddle, given), 0);
  addUp(impulse, angular, false);
  if (gl_LocalInvocationIndex == 0) {
    args.sums.at[row] = impulse;
    args.sums.at[row + args.blocks] = angular;
  }
  barrier();
}

// `byWalls` and `byModel`: the parts of the change that walls and the model have made so far.
void settleSlot(bool isParticle, vec3 predicted, vec3 velocity, vec3 change, vec3 byWalls, vec3 byModel,
                float compression) {
  const uint slot = threadIndex(), block = workgroupIndex();
  const float mass = SETTING.mass;
  vec4 onWalls = vec4(0), momentum = vec4(0);
  vec3 modelMet = vec3(0);
  if (isParticle) {
    Settled settled = settle(stoppingWalls(), predicted, velocity, change);
    if (hasModel()) {
      const vec3 away = keptOut(modelField(), modelAbout(settled.place)) / SETTING.step, stop = settled.stop;
      byModel += away;
      modelMet = settled.place;
      settled = settle(stoppingWalls(), settled.place, settled.velocity, away);
      settled.stop += stop;
    }
    args.positions.at[slot] = vec4(settled.place, 0);
    args.velocities.at[(1 - args.control.now.parity) * args.particles + slot] = vec4(settled.velocity, 0);
    onWalls = vec4(-mass * (byWalls + settled.stop), 0.5f * mass * dot(settled.velocity, settled.velocity));
    momentum = vec4(mass * settled.velocity, compression);
  }
  if (hasModel()) noteModel(byModel, modelMet);
  addUp(onWalls, momentum, true);
  if (gl_LocalInvocationIndex == 0) {
    args.sums.at[block] = onWalls;
    args.sums.at[args.blocks + block] = momentum;
  }
}

#endif
