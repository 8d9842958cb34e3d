#version 460
#extension GL_GOOGLE_include_directive : require
// The fused step: one workgroup gathers the points around the probe, evaluates the surface and moves the proxy, in one
// dispatch. Every invocation follows the same path with the same numbers; engine/contact/contact_reference.cpp walks it
// in double precision. Places are relative to the HIP: far from the origin, single precision would lose in absolute
// coordinates the very differences that the surface is made of.
#include "shaders/lib/index.glsl"
#include "shaders/lib/surface.glsl"

layout(push_constant, scalar) uniform Push { ContactStepArgs args; };

// The surface at a place; gathers a new patch when the place has left the old one.
Surface surfaceNear(vec3 x) {
  const float slack = kPatchSlack * args.radius;
  if (!patchGathered || distance(x, patchCentre) > slack)
    gatherPatch(args.cloud, args.spill, args.pose.at[0].hip, x, args.radius + slack);
  return surfaceAt(args.spill, x - patchCentre, args.radius);
}

vec3 shortened(vec3 step, float longest) {
  const float size = length(step);
  return size > longest ? step * (longest / size) : step;
}

void main() {
  const vec3 hip = args.pose.at[0].hip;
  const bool started = args.state.at[0].started != 0;
  const vec3 lastHip = started ? args.state.at[0].lastHip - hip : vec3(0.0);
  bool touching = started && args.state.at[0].touching != 0;
  uint side = started ? args.state.at[0].side : kSideUnknown;
  vec3 proxy = touching ? args.state.at[0].spring + lastHip : vec3(0.0);

  const float longest = kLongestStep * args.radius;
  Surface surface = Surface(false, 0.0, vec3(0.0), 0);
  if (touching) surface = surfaceNear(proxy);
  bool truncated = false;

  // Free: walk the segment of the HIP's motion and touch where it comes from outside to inside.
  if (!touching) {
    const uint steps = clamp(uint(ceil(length(lastHip) / longest)), 1u, kMaxSubsteps);
    vec3 outside = lastHip;
    for (uint s = 1; s <= steps && !touching; ++s) {
      truncated = workDone > kContactWorkBudget;
      if (truncated) {
        side = kSideUnknown;
        break;
      }
      const vec3 x = lastHip * (float(steps - s) / float(steps));
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
    if (touching) surface = surfaceNear(proxy);
  }

  // Touching: project onto the surface and follow the HIP in the tangent plane until the proxy rests.
  uint trackingSteps = 0;
  if (touching) {
    vec3 lastSlide = vec3(0.0);
    float relaxation = 1.0;
    for (; trackingSteps < kMaxTrackingSteps && surface.defined; ++trackingSteps) {
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
      surface = surfaceNear(proxy);
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
  args.state.at[0].lastHip = hip;
  args.state.at[0].side = side;
  args.state.at[0].started = 1;
  args.state.at[0].spring = proxy;
  args.result.at[0].spring = proxy;
  args.result.at[0].touching = touching ? 1 : 0;
  args.result.at[0].normal = surface.normal;
  args.result.at[0].neighbours = surface.neighbours;
  args.result.at[0].tick = args.pose.at[0].tick;
  args.result.at[0].trackingSteps = trackingSteps;
  args.result.at[0].logHead = args.logHead.at[0];
  args.result.at[0].flags = (truncated ? kSampleTruncated : 0) | (patchThinned ? kSampleThinned : 0);
}
