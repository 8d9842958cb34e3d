// What the contact steps share, whether they wait for their question or not: the surface at a position of the patch,
// and the answer. Every invocation follows the same path with the same numbers;
// engine/contact/contact_reference.cpp does the same in double precision. Positions are relative to the HIP: far from
// the origin, absolute coordinates in single precision would lose the small differences that define the surface.
#ifndef PALPATE_LIB_CONTACT_STEP_GLSL
#define PALPATE_LIB_CONTACT_STEP_GLSL

#include "shaders/lib/probe.glsl"

layout(push_constant, scalar) uniform Push { ContactStepArgs args; };
#include "shaders/lib/split_gather.glsl"
#include "shaders/lib/surface.glsl"

layout(constant_id = 3) const float kFriction = 0.0;

ProxyTick tick;
vec3 facing;

bool patchReaches(vec3 x) { return patchGathered && distance(x, patchCentre) <= kPatchSlack * args.radius; }

// The surface at a position within the patch, of the points that belong to the face felt last; past the edge of such a
// sheet every point counts. Its outside is the felt face.
Surface feel(vec3 x) {
  Surface surface;
  for (uint look = 0; look < 2; ++look) {
    surface = surfaceAt(args.spill, x - patchCentre, args.radius, facing);
    if (surface.defined || facing == vec3(0.0)) break;
    facing = vec3(0.0);
  }
  facing = surface.normal;
  if (tick.touching && tick.face == kFaceBehind) {
    surface.normal = -surface.normal;
    surface.distance = -surface.distance;
  }
  return surface;
}

// Written by as many invocations as there are words, so that all of it crosses the bus at once.
void writeAnswer(uint i, ContactSample answer) {
  const uint words[kSampleWords] = uint[](
      floatBitsToUint(answer.spring.x), floatBitsToUint(answer.spring.y), floatBitsToUint(answer.spring.z),
      answer.touching, floatBitsToUint(answer.normal.x), floatBitsToUint(answer.normal.y),
      floatBitsToUint(answer.normal.z), answer.neighbours, answer.tick, answer.trackingSteps, answer.logHead,
      answer.flags, floatBitsToUint(answer.velocity.x), floatBitsToUint(answer.velocity.y),
      floatBitsToUint(answer.velocity.z), sealOf(answer));
  uint word = 0;
  [[unroll]] for (uint k = 0; k < kSampleWords; ++k) word = gl_LocalInvocationIndex == k ? words[k] : word;
  args.result.words[i * kSampleWords + gl_LocalInvocationIndex] = word;
}

#endif
