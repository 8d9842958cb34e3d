#version 460
#extension GL_GOOGLE_include_directive : require
// The contact step: gathers the points around the probe, evaluates the surface and moves the proxy. Fused, it is one
// dispatch of one workgroup, or of one for each point of a tool; the first patch may also come from several workgroups,
// or from the passes of another query method.
#include "shaders/lib/index.glsl"
#include "shaders/lib/contact_step.glsl"

layout(constant_id = 4) const bool kManyProbes = false;

// The probe's number: a tool with several has one workgroup for each, and these are independent.
uint probeIndex() { return kManyProbes ? gl_WorkGroupID.x : 0; }

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
  facing = probe.facing;
  tick = tickFrom(probe.touching, probe.sticking, probe.face, facing, probe.lastHip, probe.proxy, vec3(0.0),
                  args.radius, kFriction);
  Surface surface = Surface(false, 0.0, vec3(0.0), 0, false);

  // One loop for all purposes: shader compilers inline every call, and the patch and its surface are most of the
  // program.
  do {
    if (tick.purpose == kWalks) tick.at = placeOnWay(probe, tick.substep);
    bool spent = workDone > kContactWorkBudget;
    bool fetched = false;  // a patch around the place was gathered: a NaN is out of reach of every patch, also its own
    while (!fetched && !patchReaches(tick.at)) {
      fetched = patchGathered;
      gatherPatch(args.spill, probe.hip, fetched ? tick.at : firstPlace(probe), patchReach(args.radius),
                  args.mostCells);
      if (!fetched) spent = workDone > kContactWorkBudget;
    }
    if (tick.purpose == kWalks && spent) {
      tick.truncated = true;
      tick.face = kFaceInside;
      break;
    }
    surface = feel(tick.at);
    if (tick.purpose == kWalks) ++workDone;
  } while (goesOn(tick, surface, vec3(0.0), args.radius, kFriction, probe.substeps, probe.traced,
                  workDone > kContactWorkBudget));
  const vec3 proxy = tick.touching ? tick.proxy : vec3(0.0);
  const uint touching = !tick.touching ? kFree : tick.sticking ? kSticking : kSliding;

  vec3 velocity = vec3(0.0);
  if (kPointsMove && surface.defined)
    velocity = velocityAt(args.spill, args.velocities, tick.at - patchCentre, args.radius, facing);
  if (gl_LocalInvocationIndex >= kSampleWords) return;
  ContactSample answer;
  answer.spring = proxy;
  answer.touching = touching;
  answer.normal = surface.normal;
  answer.neighbours = surface.neighbours;
  answer.tick = args.pose.at[i].pose.tick;
  answer.trackingSteps = tick.trackingSteps;
  answer.logHead = args.logHead.at[0];
  answer.flags = (tick.truncated ? kSampleTruncated : 0) | (patchThinned ? kSampleThinned : 0);
  answer.flags |= tick.face << kSampleFaceShift;
  answer.velocity = velocity;
  writeAnswer(i, answer);
  if (gl_LocalInvocationIndex != 0) return;
  args.state.at[i].touching = touching;
  args.state.at[i].facing = facing;
  args.state.at[i].lastHip = args.pose.at[i].pose.hip;
  args.state.at[i].face = tick.face;
  args.state.at[i].started = 1;
  args.state.at[i].motion = -probe.lastHip;
  args.state.at[i].spring = proxy;
  if (kPointsMove) args.state.at[i].velocity = velocity;
}
