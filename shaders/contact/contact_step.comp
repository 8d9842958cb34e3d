#version 460
#extension GL_GOOGLE_include_directive : require
// The contact step: gathers the points around the probe, evaluates the surface and moves the proxy. Fused, that is one
// dispatch of one workgroup; the first patch may also come from several workgroups, or from the passes of another query
// method. Every invocation follows the same path with the same numbers; engine/contact/contact_reference.cpp walks it
// in double precision. Places are relative to the HIP: far from the origin, single precision would lose in absolute
// coordinates the very differences that the surface is made of.
#include "shaders/lib/index.glsl"
#include "shaders/lib/probe.glsl"
#include "shaders/lib/split_gather.glsl"
#include "shaders/lib/surface.glsl"

layout(push_constant, scalar) uniform Push { ContactStepArgs args; };

// The surface at a place; gathers a new patch when the place has left the old one.
Surface surfaceNear(vec3 x) {
  if (!patchGathered || distance(x, patchCentre) > kPatchSlack * args.radius)
    gatherPatch(args.cloud, args.spill, args.pose.at[0].hip, x, patchReach(args.radius), args.mostCells);
  return surfaceAt(args.spill, x - patchCentre, args.radius);
}

vec3 shortened(vec3 step, float longest) {
  const float size = length(step);
  return size > longest ? step * (longest / size) : step;
}

// False in a workgroup that has done its share of a split gather and may go.
bool takeFirstPatch(Probe probe) {
  if (args.gather == kGatherAlone) return true;
  if (args.gather == kGatherSplit) {
    gatherShare(args.cloud, args.gathered, probe.hip, firstPlace(probe), patchReach(args.radius), args.mostCells);
    if (!finishesLast(args.gathered)) return false;
  }
  takePatch(args.gathered, args.spill);
  if (args.gather == kGatherSplit) clearShares(args.gathered);
  return true;
}

void main() {
  const Probe probe = probeOf(args.pose, args.state, args.radius);
  if (!takeFirstPatch(probe)) return;
  bool touching = probe.touching;
  uint side = probe.side;
  vec3 proxy = probe.proxy;

  const float longest = kLongestStep * args.radius;
  Surface surface = Surface(false, 0.0, vec3(0.0), 0);
  bool truncated = false;

  // Free: walk the segment of the HIP's motion and touch where it comes from outside to inside.
  if (!touching) {
    vec3 outside = probe.lastHip;
    for (uint s = 1; s <= probe.substeps && !touching; ++s) {
      truncated = workDone > kContactWorkBudget;
      if (truncated) {
        side = kSideUnknown;
        break;
      }
      const vec3 x = placeOnWay(probe, s);
      surface = surfaceNear(x);
      ++workDone;
      if (!surface.defined) {
        side = kSideUnknown;
      } else if (surface.distance > 0.0) {
        side = kSideOutside;
        outside = x;
      } else if (side == kSideOutside) {
        touching = true;
        proxy = outside;
      } else {
        side = kSideInside;
      }
    }
  }

  // Touching: project onto the surface and follow the HIP in the tangent plane until the proxy rests.
  uint trackingSteps = 0;
  if (touching) {
    vec3 lastSlide = vec3(0.0);
    float relaxation = 1.0;
    while (true) {
      surface = surfaceNear(proxy);
      if (trackingSteps == kMaxTrackingSteps || !surface.defined) break;
      const vec3 n = surface.normal;
      const vec3 lift = -surface.distance * n;
      const vec3 slide = dot(proxy, n) * n - proxy;
      if (length(lift) < kConvergence * args.radius && length(slide) < kConvergence * args.radius) break;
      truncated = workDone > kContactWorkBudget;
      if (truncated) break;
      // A slide that turns back has overshot, as it does in a hollow narrower than the HIP is deep.
      if (dot(slide, lastSlide) < 0.0) relaxation *= 0.5;
      lastSlide = slide;
      proxy += shortened(lift, longest) + shortened(relaxation * slide, longest);
      ++trackingSteps;
    }
    if (!surface.defined) {
      touching = false;
      side = kSideUnknown;
    } else if (dot(proxy, surface.normal) < 0.0) {
      touching = false;
      side = kSideOutside;
    }
    if (!touching) {
      proxy = vec3(0.0);
      surface = surfaceNear(proxy);
    }
  }

  if (gl_LocalInvocationIndex != 0) return;
  args.state.at[0].touching = touching ? 1 : 0;
  args.state.at[0].lastHip = probe.hip;
  args.state.at[0].side = side;
  args.state.at[0].started = 1;
  args.state.at[0].spring = proxy;
  ContactSample answer;
  answer.spring = proxy;
  answer.touching = touching ? 1 : 0;
  answer.normal = surface.normal;
  answer.neighbours = surface.neighbours;
  answer.tick = args.pose.at[0].tick;
  answer.trackingSteps = trackingSteps;
  answer.logHead = args.logHead.at[0];
  answer.flags = (truncated ? kSampleTruncated : 0) | (patchThinned ? kSampleThinned : 0);
  answer.flags |= side << kSampleSideShift;
  args.result.at[0].spring = answer.spring;
  args.result.at[0].touching = answer.touching;
  args.result.at[0].normal = answer.normal;
  args.result.at[0].neighbours = answer.neighbours;
  args.result.at[0].tick = answer.tick;
  args.result.at[0].trackingSteps = answer.trackingSteps;
  args.result.at[0].logHead = answer.logHead;
  args.result.at[0].flags = answer.flags;
  args.result.at[0].seal = sealOf(answer);
}
