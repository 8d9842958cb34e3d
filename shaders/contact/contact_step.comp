#version 460
#extension GL_GOOGLE_include_directive : require
// The contact step: gathers the points around the probe, evaluates the surface and moves the proxy. Fused, it is one
// dispatch of one workgroup, or of one for each point of a tool; the first patch may also come from several workgroups,
// or from the passes of another query method. Every invocation follows the same path with the same numbers;
// engine/contact/contact_reference.cpp does the same in double precision. Positions are relative to the HIP: far from
// the origin, absolute coordinates in single precision would lose the small differences that define the surface.
#include "shaders/lib/index.glsl"
#include "shaders/lib/probe.glsl"

layout(push_constant, scalar) uniform Push { ContactStepArgs args; };
#include "shaders/lib/split_gather.glsl"
#include "shaders/lib/surface.glsl"

layout(constant_id = 3) const float kFriction = 0.0;
layout(constant_id = 4) const bool kManyProbes = false;

// The probe's number: a tool with several has one workgroup for each, and these are independent.
uint probeIndex() { return kManyProbes ? gl_WorkGroupID.x : 0; }

bool touching, sticking;
uint face;
vec3 facing;

// Purposes of a step when it evaluates the surface.
const uint kWalks = 0;   // free, along the HIP's motion, until it crosses the surface
const uint kTracks = 1;  // touching, from tangent plane to tangent plane
const uint kLeaves = 2;  // no longer touching, at the HIP

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
  if (touching && face == kFaceBehind) {
    surface.normal = -surface.normal;
    surface.distance = -surface.distance;
  }
  return surface;
}

// Takes over the first patch if others gather it, too. False in a workgroup that has done its share and may end.
bool takeFirstPatch(Probe probe) {
  if (kManyProbes || args.gather == kGatherAlone) return true;
  if (args.gather == kGatherSplit) {
    gatherShare(args.gathered, probe.hip, firstPlace(probe), patchReach(args.radius), args.mostCells);
    if (!finishesLast(args.gathered)) return false;
  }
  takePatch(args.gathered, args.spill);
  if (args.gather == kGatherSplit) clearShares(args.gathered);
  return true;
}

// A hand in contact felt the surface at the proxy: its first slide follows that surface, without another evaluation.
Tracking takeFirstSlide(inout vec3 proxy) {
  vec3 slide = vec3(0.0);
  if (touching && facing != vec3(0.0))
    slide = slideAlong(face == kFaceBehind ? -facing : facing, proxy, kFriction, sticking);
  Tracking tracking = trackingFrom(slide, sticking, kConvergence * args.radius);
  if (tracking.slid) proxy += shortened(slide, kLongestStep * args.radius);
  return tracking;
}

// Touching: takes the step that the surface at the proxy requires. False if the proxy rests.
bool takesStep(inout Tracking tracking, inout vec3 proxy, Surface surface, inout uint steps, inout bool truncated) {
  if (steps == kMaxTrackingSteps || !surface.defined) return false;
  const float arrived = kConvergence * args.radius;
  const TrackingStep step = nextStep(tracking, proxy, surface.normal, surface.distance, kFriction);
  truncated = step.size >= arrived && workDone > kContactWorkBudget;
  if (truncated || step.size < arrived) return false;
  proxy += takeStep(tracking, step, kLongestStep * args.radius);
  ++steps;
  return step.size >= kLastStep * args.radius;
}

void main() {
  const uint i = probeIndex();
  if (args.pose.at[i].pose.tick == 0) return;  // its question has not arrived
  if (kManyProbes) patchSpill = i * args.spillSlots;
  const Probe probe = probeOf(args.pose, args.state, i, args.radius);
  if (kPointsMove) {
    patchAge = args.pose.at[i].pointsAge;
    patchVelocity = probe.velocity;
  }
  if (!takeFirstPatch(probe)) return;
  touching = probe.touching;
  sticking = probe.sticking;
  face = probe.face;
  facing = probe.facing;
  vec3 proxy = probe.proxy;
  Surface surface = Surface(false, 0.0, vec3(0.0), 0, false);
  bool truncated = false;
  uint trackingSteps = 0;

  Tracking tracking = takeFirstSlide(proxy);
  uint purpose = touching ? kTracks : kWalks;
  uint substep = 1;
  vec3 before = probe.lastHip;
  vec3 x = touching ? proxy : placeOnWay(probe, substep);
  // One loop for all purposes: shader compilers inline every call, and the patch and its surface are most of the
  // program.
  while (true) {
    bool spent = workDone > kContactWorkBudget;
    bool fetched = false;  // a patch around x was gathered: a NaN is out of reach of every patch, also of its own
    while (!fetched && !patchReaches(x)) {
      fetched = patchGathered;
      gatherPatch(args.spill, probe.hip, fetched ? x : firstPlace(probe), patchReach(args.radius), args.mostCells);
      if (!fetched) spent = workDone > kContactWorkBudget;
    }
    if (purpose == kWalks && spent) {
      truncated = true;
      face = kFaceInside;
      break;
    }
    surface = feel(x);
    if (purpose == kLeaves) break;
    if (purpose == kWalks) {
      ++workDone;
      const bool inFront = surface.distance > 0.0;
      if (surface.defined && crosses(face, inFront)) {
        purpose = kTracks;
        touching = true;
        sticking = true;
        tracking = trackingFrom(vec3(0.0), sticking, kConvergence * args.radius);
        x = proxy = before;
        continue;
      }
      face = faceAfter(face, surface.defined, surface.ends, inFront, probe.traced);
      if (substep == probe.substeps) break;
      before = x;
      x = placeOnWay(probe, ++substep);
      continue;
    }
    if (takesStep(tracking, proxy, surface, trackingSteps, truncated)) {
      x = proxy;
      continue;
    }
    sticking = !tracking.slid;
    if (surface.defined && dot(proxy, surface.normal) >= 0.0) break;
    if (!surface.defined) face = kFaceInside;  // lost inside: not caught again on the way out
    purpose = kLeaves;
    touching = false;
    x = proxy = vec3(0.0);
  }

  vec3 velocity = vec3(0.0);
  if (kPointsMove && surface.defined)
    velocity = velocityAt(args.spill, args.velocities, x - patchCentre, args.radius, facing);
  if (gl_LocalInvocationIndex != 0) return;
  args.state.at[i].touching = !touching ? kFree : sticking ? kSticking : kSliding;
  args.state.at[i].facing = facing;
  args.state.at[i].lastHip = args.pose.at[i].pose.hip;
  args.state.at[i].face = face;
  args.state.at[i].started = 1;
  args.state.at[i].motion = -probe.lastHip;
  args.state.at[i].spring = proxy;
  if (kPointsMove) args.state.at[i].velocity = velocity;
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
  answer.velocity = velocity;
  args.result.at[i].spring = answer.spring;
  args.result.at[i].touching = answer.touching;
  args.result.at[i].normal = answer.normal;
  args.result.at[i].neighbours = answer.neighbours;
  args.result.at[i].tick = answer.tick;
  args.result.at[i].trackingSteps = answer.trackingSteps;
  args.result.at[i].logHead = answer.logHead;
  args.result.at[i].flags = answer.flags;
  if (kPointsMove) args.result.at[i].velocity = answer.velocity;
  args.result.at[i].seal = sealOf(answer);
}
