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

layout(constant_id = 3) const float kFriction = 0.0;

bool touching, sticking;
uint side;
vec3 facing;

// The surface at a place, of the points that face the side felt last; past the edge of such a sheet every point counts.
// Its outside is the side that is felt. Gathers a new patch when the place has left the old one.
Surface feel(vec3 x) {
  if (!patchGathered || distance(x, patchCentre) > kPatchSlack * args.radius)
    gatherPatch(args.cloud, args.spill, args.pose.at[0].hip, x, patchReach(args.radius), args.mostCells);
  Surface surface;
  for (uint look = 0; look < 2; ++look) {
    surface = surfaceAt(args.spill, x - patchCentre, args.radius, facing);
    if (surface.defined || facing == vec3(0.0)) break;
    facing = vec3(0.0);
  }
  facing = surface.normal;
  if (touching && side == kSideBehind) {
    surface.normal = -surface.normal;
    surface.distance = -surface.distance;
  }
  return surface;
}

vec3 shortened(vec3 step, float longest) {
  const float size = length(step);
  return size > longest ? step * (longest / size) : step;
}

// The part of a slide that friction leaves: the proxy is held while the force stays in the cone, and dragged along its
// border once it has left it (Ruspini, Kolarov, Khatib 1997).
vec3 againstFriction(vec3 slide, float depth) {
  const float size = length(slide);
  const float held = kFriction * max(0.0, depth);
  return size <= (sticking ? kStaticFriction * held : held) ? vec3(0.0) : slide * (1.0 - held / size);
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

// Free: walks the segment of the HIP's motion and touches where it crosses the surface.
void walkFreely(Probe probe, inout vec3 proxy, inout Surface surface, inout bool truncated) {
  vec3 before = probe.lastHip;
  for (uint s = 1; s <= probe.substeps && !touching; ++s) {
    truncated = workDone > kContactWorkBudget;
    if (truncated) {
      side = kSideInside;
      break;
    }
    const vec3 x = placeOnWay(probe, s);
    surface = feel(x);
    ++workDone;
    const bool inFront = surface.distance > 0.0;
    if (!surface.defined) {
      if (side != kSideInside) side = kSideUnknown;
    } else if ((inFront && side == kSideBehind) || (!inFront && side == kSideOutside)) {
      touching = true;
      sticking = true;
      proxy = before;
    } else if (inFront) {
      side = kSideOutside;
    } else if (side == kSideUnknown) {
      side = probe.traced ? kSideBehind : kSideInside;
    }
    before = x;
  }
}

// Touching: projects the proxy onto the surface and follows the HIP in the tangent plane until it rests. Gives back the
// steps that it took.
uint track(inout vec3 proxy, inout Surface surface, inout bool truncated) {
  const float longest = kLongestStep * args.radius;
  const float arrived = kConvergence * args.radius;
  uint steps = 0;
  vec3 lastSlide = vec3(0.0);
  float relaxation = 1.0;
  bool slid = false;
  while (true) {
    surface = feel(proxy);
    if (steps == kMaxTrackingSteps || !surface.defined) break;
    const vec3 n = surface.normal;
    const vec3 lift = -surface.distance * n;
    const float depth = dot(proxy, n);
    const vec3 slide = againstFriction(depth * n - proxy, depth);
    if (length(lift) < arrived && relaxation * length(slide) < arrived) break;
    truncated = workDone > kContactWorkBudget;
    if (truncated) break;
    // A slide that turns back has overshot, as it does in a hollow narrower than the HIP is deep.
    if (dot(slide, lastSlide) < 0.0) relaxation *= 0.5;
    lastSlide = slide;
    if (slide != vec3(0.0)) {
      slid = true;
      sticking = false;
    }
    proxy += shortened(lift, longest) + shortened(relaxation * slide, longest);
    ++steps;
  }
  sticking = !slid;
  return steps;
}

void main() {
  if (args.pose.at[0].tick == 0) return;  // it was waited for in vain
  const Probe probe = probeOf(args.pose, args.state, args.radius);
  if (!takeFirstPatch(probe)) return;
  touching = probe.touching;
  sticking = probe.sticking;
  side = probe.side;
  facing = probe.facing;
  vec3 proxy = probe.proxy;
  Surface surface = Surface(false, 0.0, vec3(0.0), 0);
  bool truncated = false;
  uint trackingSteps = 0;

  if (!touching) walkFreely(probe, proxy, surface, truncated);
  if (touching) {
    trackingSteps = track(proxy, surface, truncated);
    if (!surface.defined) {
      touching = false;
      side = kSideInside;  // lost within: not caught again on the way out
    } else if (dot(proxy, surface.normal) < 0.0) {
      touching = false;
    }
    if (!touching) {
      proxy = vec3(0.0);
      surface = feel(proxy);
    }
  }

  if (gl_LocalInvocationIndex != 0) return;
  args.state.at[0].touching = !touching ? kFree : sticking ? kSticking : kSliding;
  args.state.at[0].facing = facing;
  args.state.at[0].lastHip = probe.hip;
  args.state.at[0].side = side;
  args.state.at[0].started = 1;
  args.state.at[0].motion = -probe.lastHip;
  args.state.at[0].spring = proxy;
  ContactSample answer;
  answer.spring = proxy;
  answer.touching = !touching ? kFree : sticking ? kSticking : kSliding;
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
