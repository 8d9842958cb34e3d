#version 460
#extension GL_GOOGLE_include_directive : require
// Water, first half: the compression of each particle, from the sum of weights of everything near it.
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterCompressArgs args; };

#include "shaders/lib/matter_lists.glsl"
#include "shaders/lib/matter_setting.glsl"
#include "shaders/lib/matter_body.glsl"
#include "shaders/lib/matter_model.glsl"

float bodyWeights = 0;
void meetPoint(BodyMeeting met, uint number) { bodyWeights += met.volume * wendland(met.r); }

void main() {
  const uint slot = threadIndex();
  if (slot >= args.particles || !isRunning()) return;
  const WaterRules rules = waterRules();
  const vec3 place = args.places.at[slot].xyz, size = SETTING.cells.size;
  const uint count = args.listLengths.at[slot];
  const float perSupport = 1 / rules.support;
  float sum = 1;  // the particle itself
  for (uint first = 0; first < count; first += kListedAtOnce) {
    const uvec4 four = args.lists.at[first / kListedAtOnce * args.stride + slot];
    vec3 others[kListedAtOnce];  // all loads are issued before the first one is needed
    [[unroll]] for (uint k = 0; k < kListedAtOnce; ++k) others[k] = args.places.at[slotOf(four[k])].xyz;
    [[unroll]] for (uint k = 0; k < kListedAtOnce; ++k) {
      const float r = length(offsetFrom(four[k], others[k], place, size)) * perSupport;
      sum += first + k < count ? wendland(min(r, 1)) : 0;
    }
  }
  for (uint tool = 0; tool < args.toolCount; ++tool) {
    const BodyPose pose = poseOf(tool);
    if (isNear(pose, place)) meetPoints(pose, place);
  }
  const WallEffect walls = wallsAt(rules, place);
  const ModelAt model = modelAbout(place);
  sum += bodyWeights + wallsBesideModel(walls, model).sum + modelEffect(rules, model, walls).sum;
  args.pressed.at[slot] = vec4(place, compressionOf(rules, sum));
}
