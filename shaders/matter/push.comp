#version 460
#extension GL_GOOGLE_include_directive : require
// Water, second half: the change of each particle's velocity, from the pushes of everything near it, and its new
// position.
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterPushArgs args; };

#include "shaders/lib/matter_lists.glsl"
#include "shaders/lib/matter_setting.glsl"
#include "shaders/lib/matter_body.glsl"
#include "shaders/lib/matter_model.glsl"
#include "shaders/lib/matter_sums.glsl"
#include "shaders/lib/matter_settle.glsl"

WaterRules rules;
vec4 place;  // w: compression
float pressed;  // the part of it that pushes
vec3 velocity;

vec3 byNeighbour(vec3 offset, float r, float compression, vec3 relative) {
  const vec3 change = changeByNeighbour(rules, offset, wendlandPull(r), pressed + pressing(compression), relative);
  if (rules.cohesion == 0) return change;
  return change + changeByCohesion(rules, offset, r, atSurface(place.w) + atSurface(compression));
}

vec3 changeByNeighbours(uint slot) {
  const uint count = args.listLengths.at[slot], before = args.control.now.parity * args.particles;
  const vec3 size = SETTING.cells.size, fall = SETTING.fall;
  const float perSupport = 1 / rules.support;
  vec3 change = vec3(0);
  for (uint first = 0; first < count; first += kListedAtOnce) {
    const uvec4 four = args.lists.at[first / kListedAtOnce * args.stride + slot];
    vec4 others[kListedAtOnce];  // all loads are issued before the first one is needed
    vec3 relative[kListedAtOnce];
    [[unroll]] for (uint k = 0; k < kListedAtOnce; ++k) others[k] = args.pressed.at[slotOf(four[k])];
    [[unroll]] for (uint k = 0; k < kListedAtOnce; ++k)
      relative[k] = args.velocities.at[before + slotOf(four[k])].xyz + fall - velocity;
    [[unroll]] for (uint k = 0; k < kListedAtOnce; ++k) {
      const vec3 offset = offsetFrom(four[k], others[k].xyz, place.xyz, size);
      const float r = length(offset) * perSupport;
      if (first + k < count && r < 1)
        change += byNeighbour(offset, r, others[k].w, relative[k]);
    }
  }
  return change;
}

void meetPoint(BodyMeeting met, uint number) {
  const vec3 change =
      met.volume * changeByNeighbour(rules, met.offset, wendlandPull(met.r), pressed, met.velocity - velocity);
  noteExchange(change, met.arm);
}

void main() {
  if (!isRunning()) return;
  const uint slot = threadIndex();
  const bool isParticle = slot < args.particles;
  vec3 change = vec3(0), byWalls = vec3(0), byModel = vec3(0);
  if (isParticle) {
    rules = waterRules();
    place = args.pressed.at[slot];
    pressed = pressing(place.w);
    velocity = velocityOf(slot);
    change = changeByNeighbours(slot);
    const WallEffect walls = wallsAt(rules, place.xyz);
    const ModelAt model = modelAbout(place.xyz);
    byWalls = changeByWalls(rules, wallsBesideModel(walls, model), pressed, velocity);
    byModel = changeByWalls(rules, modelEffect(rules, model, walls), pressed, velocity);
  }
  change += changeByTools(isParticle, place.xyz) + byWalls + byModel;
  settleSlot(isParticle, place.xyz, velocity, change, byWalls, byModel, pressed);
}
