// The end of a pass that moves particles: the exchange of a particle with tools, and its new position. Requires `args`
// with the fields used here, and that meetPoint() calls noteExchange(). All invocations of a workgroup of kMatterBlock
// call the functions together.
#ifndef PALPATE_LIB_MATTER_SETTLE_GLSL
#define PALPATE_LIB_MATTER_SETTLE_GLSL

// Exchange of this invocation's particle with the tool at hand: change of its velocity, and the angular part for the
// tool.
vec3 toolChange, toolTurn;
uint toolAtHand;
shared uint meetsTool;  // whether any particle of the workgroup is near

void noteExchange(vec3 change, vec3 arm) {
  toolChange += change;
  toolTurn += cross(arm, change);
}

// Predicted velocity of a slot, with the change by gravity.
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

// Impulse of a particle on the model, row by row over the blocks.
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

// `byWalls` and `byModel`: the parts of the change by walls and by the model so far.
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
