// State of the probe when a tick begins, and the position around which its first patch is gathered. Every method has to
// compute the same bits here: hence `precise`.
//
// If points move, a step is taken in the frame of the surface that was felt last, at the time of the points' positions:
// the HIP is transformed back by the motion of that surface since then, and its displacement is the one relative to the
// surface. So the surface carries the proxy along, and only relative displacement decides what crosses it.
#ifndef PALPATE_LIB_PROBE_GLSL
#define PALPATE_LIB_PROBE_GLSL

#include "shaders/lib/contact_buffers.glsl"
#include "shaders/shared/proxy.h"

// If false, nothing is read for the motion of points.
layout(constant_id = 7) const bool kPointsMove = true;

// Positions are relative to the HIP, except the HIP itself.
struct Probe {
  vec3 hip;  // model units relative to the cloud's origin, at the time of the indexed points
  vec3 lastHip;
  vec3 proxy;
  bool traced;  // the sub-steps cover the path since the last tick
  bool touching;
  bool sticking;
  uint face;
  vec3 facing;
  uint substeps;  // of a free HIP, for its path since the last tick
  vec3 velocity;  // of the surface in whose frame the step is taken; zero if nothing was felt
};

// `i`: the number of the tool's point.
Probe probeOf(ContactPoses pose, ContactStates state, uint i, float radius) {
  Probe probe;
  probe.hip = pose.at[i].pose.hip;
  const bool carried = pose.at[i].carried.started != 0;
  const bool started = carried || state.at[i].started != 0;
  const vec3 lastHip = carried ? pose.at[i].carried.lastHip : state.at[i].lastHip;
  const uint touching = carried ? pose.at[i].carried.touching : state.at[i].touching;
  const uint face = carried ? pose.at[i].carried.face : state.at[i].face;
  const vec3 facing = carried ? pose.at[i].carried.facing : state.at[i].facing;
  const vec3 spring = carried ? pose.at[i].carried.spring : state.at[i].spring;
  precise vec3 way = started ? lastHip - probe.hip : vec3(0.0);
  probe.velocity = vec3(0.0);
  if (kPointsMove && started) {
    const vec3 velocity = carried ? pose.at[i].carried.velocity : state.at[i].velocity;
    precise vec3 moved = pose.at[i].sinceLast * velocity, age = pose.at[i].pointsAge * velocity;
    way += moved;
    probe.hip -= age;
    probe.velocity = velocity;
  }
  probe.lastHip = way;
  probe.touching = started && touching != kFree;
  probe.sticking = touching == kSticking;
  probe.face = started ? face : kFaceUnknown;
  probe.facing = started ? facing : vec3(0.0);
  probe.proxy = probe.touching ? spring + probe.lastHip : vec3(0.0);
  precise float steps = length(probe.lastHip) / (kLongestStep * radius);
  probe.traced = started && steps <= float(kMaxSubsteps);
  probe.substeps = substepsOn(steps);
  return probe;
}

// Position of a free HIP after `substep` of its sub-steps.
vec3 placeOnWay(Probe probe, uint substep) {
  precise vec3 place = probe.lastHip * (float(probe.substeps - substep) / float(probe.substeps));
  return place;
}

vec3 firstPlace(Probe probe) { return probe.touching ? probe.proxy : placeOnWay(probe, 1); }

#endif
