#version 460
#extension GL_GOOGLE_include_directive : require
// The contact step: gathers the points around the probe, evaluates the surface and moves the proxy. Fused, that is one
// dispatch of one workgroup, or of one for each point of a tool; the first patch may also come from several workgroups,
// or from the passes of another query method. Every invocation follows the same path with the same numbers;
// engine/contact/contact_reference.cpp walks it in double precision. Places are relative to the HIP: far from the
// origin, single precision would lose in absolute coordinates the very differences that the surface is made of.
#include "shaders/lib/index.glsl"
#include "shaders/lib/probe.glsl"

layout(push_constant, scalar) uniform Push { ContactStepArgs args; };
#include "shaders/lib/split_gather.glsl"
#include "shaders/lib/surface.glsl"

layout(constant_id = 3) const float kFriction = 0.0;
layout(constant_id = 4) const bool kManyProbes = false;

// Which probe this is: a tool of many has a workgroup for each, and none knows of the others.
uint probeIndex() { return kManyProbes ? gl_WorkGroupID.x : 0; }

bool touching, sticking;
uint face;
vec3 facing;

// The surface at a place, of the points that belong to the face that was felt last; past the edge of such a sheet every
// point counts. Its outside is the face that is felt. Gathers a new patch when the place has left the old one.
Surface feel(vec3 x) {
  if (!patchGathered || distance(x, patchCentre) > kPatchSlack * args.radius)
    gatherPatch(args.spill, args.pose.at[probeIndex()].pose.hip, x, patchReach(args.radius),
                args.mostCells);
  Surface surface;
  for (uint look = 0; look < 2; ++look) {
    surface = surfaceAt(args.spill, x - patchCentre, args.radius, facing);
    if (surface.defined || facing == vec3(0.0)) break;
    facing = vec3(0.0);
  }
  facing = surface.normal;
  if (touching && face == kFaceBehind) {
    surface.normal = -surface.normal;
    surface.distance = -surface.distance;
  }
  return surface;
}

// False in a workgroup that has done its share of a split gather and may go.
bool takeFirstPatch(Probe probe) {
  if (kManyProbes || args.gather == kGatherAlone) {
    gatherPatch(args.spill, probe.hip, firstPlace(probe), patchReach(args.radius), args.mostCells);
    return true;
  }
  if (args.gather == kGatherSplit) {
    gatherShare(args.gathered, probe.hip, firstPlace(probe), patchReach(args.radius), args.mostCells);
    if (!finishesLast(args.gathered)) return false;
  }
  takePatch(args.gathered, args.spill);
  if (args.gather == kGatherSplit) clearShares(args.gathered);
  return true;
}

// Free: walks the segment of the HIP's motion and touches where it crosses the surface.
void walkFreely(Probe probe, inout vec3 proxy, inout Surface surface, inout bool truncated) {
  vec3 before = probe.lastHip;
  for (uint s = 1; s <= probe.substeps && !touching; ++s) {
    truncated = workDone > kContactWorkBudget;
    if (truncated) {
      face = kFaceInside;
      break;
    }
    const vec3 x = placeOnWay(probe, s);
    surface = feel(x);
    ++workDone;
    const bool inFront = surface.distance > 0.0;
    if (surface.defined && crosses(face, inFront)) {
      touching = true;
      sticking = true;
      proxy = before;
    } else {
      face = faceAfter(face, surface.defined, inFront, probe.traced);
    }
    before = x;
  }
}

// Touching: projects the proxy onto the surface and follows the HIP in the tangent plane until it rests. Gives back the
// steps that it took. `touched`: in the last tick, too, which felt the surface where the proxy stands; then the first
// slide goes along that one, without another look.
uint track(bool touched, inout vec3 proxy, inout Surface surface, inout bool truncated) {
  const float longest = kLongestStep * args.radius;
  const float arrived = kConvergence * args.radius;
  const float last = kLastStep * args.radius;
  uint steps = 0;
  vec3 firstSlide = vec3(0.0);
  if (touched && facing != vec3(0.0))
    firstSlide = slideAlong(face == kFaceBehind ? -facing : facing, proxy, kFriction, sticking);
  Tracking tracking = trackingFrom(firstSlide, sticking, arrived);
  if (tracking.slid) proxy += shortened(firstSlide, longest);
  while (true) {
    surface = feel(proxy);
    if (steps == kMaxTrackingSteps || !surface.defined) break;
    const TrackingStep step = nextStep(tracking, proxy, surface.normal, surface.distance, kFriction);
    truncated = step.size >= arrived && workDone > kContactWorkBudget;
    if (truncated || step.size < arrived) break;
    proxy += takeStep(tracking, step, longest);
    ++steps;
    if (step.size < last) break;
  }
  sticking = !tracking.slid;
  return steps;
}

void main() {
  const uint i = probeIndex();
  if (args.pose.at[i].pose.tick == 0) return;  // it was waited for in vain
  if (kManyProbes) patchSpill = i * args.spillSlots;
  const Probe probe = probeOf(args.pose, args.state, i, args.radius);
  if (!takeFirstPatch(probe)) return;
  touching = probe.touching;
  sticking = probe.sticking;
  face = probe.face;
  facing = probe.facing;
  vec3 proxy = probe.proxy;
  Surface surface = Surface(false, 0.0, vec3(0.0), 0);
  bool truncated = false;
  uint trackingSteps = 0;

  if (!touching) walkFreely(probe, proxy, surface, truncated);
  if (touching) {
    trackingSteps = track(probe.touching, proxy, surface, truncated);
    if (!surface.defined) {
      touching = false;
      face = kFaceInside;  // lost within: not caught again on the way out
    } else if (dot(proxy, surface.normal) < 0.0) {
      touching = false;
    }
    if (!touching) {
      proxy = vec3(0.0);
      surface = feel(proxy);
    }
  }

  if (gl_LocalInvocationIndex != 0) return;
  args.state.at[i].touching = !touching ? kFree : sticking ? kSticking : kSliding;
  args.state.at[i].facing = facing;
  args.state.at[i].lastHip = probe.hip;
  args.state.at[i].face = face;
  args.state.at[i].started = 1;
  args.state.at[i].motion = -probe.lastHip;
  args.state.at[i].spring = proxy;
  ContactSample answer;
  answer.spring = proxy;
  answer.touching = !touching ? kFree : sticking ? kSticking : kSliding;
  answer.normal = surface.normal;
  answer.neighbours = surface.neighbours;
  answer.tick = args.pose.at[i].pose.tick;
  answer.trackingSteps = trackingSteps;
  answer.logHead = args.logHead.at[0];
  answer.flags = (truncated ? kSampleTruncated : 0) | (patchThinned ? kSampleThinned : 0);
  answer.flags |= face << kSampleFaceShift;
  args.result.at[i].spring = answer.spring;
  args.result.at[i].touching = answer.touching;
  args.result.at[i].normal = answer.normal;
  args.result.at[i].neighbours = answer.neighbours;
  args.result.at[i].tick = answer.tick;
  args.result.at[i].trackingSteps = answer.trackingSteps;
  args.result.at[i].logHead = answer.logHead;
  args.result.at[i].flags = answer.flags;
  args.result.at[i].seal = sealOf(answer);
}
