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

// Field by field: a layer reports a copy of a whole struct as out of bounds at the end of a buffer.
ContactState stateAt(ContactStates states, uint i) {
  ContactState state;
  state.lastHip = states.at[i].lastHip;
  state.touching = states.at[i].touching;
  state.spring = states.at[i].spring;
  state.face = states.at[i].face;
  state.motion = vec3(0.0);  // no step reads it
  state.facing = states.at[i].facing;
  state.velocity = kPointsMove ? states.at[i].velocity : vec3(0.0);
  state.started = states.at[i].started;
  return state;
}

ContactQuestion questionAt(ContactPoses poses, uint i) {
  ContactQuestion question;
  question.pose.hip = poses.at[i].pose.hip;
  question.pose.tick = poses.at[i].pose.tick;
  question.carried.lastHip = poses.at[i].carried.lastHip;
  question.carried.touching = poses.at[i].carried.touching;
  question.carried.spring = poses.at[i].carried.spring;
  question.carried.face = poses.at[i].carried.face;
  question.carried.motion = vec3(0.0);
  question.carried.facing = poses.at[i].carried.facing;
  question.carried.velocity = poses.at[i].carried.velocity;
  question.carried.started = poses.at[i].carried.started;
  question.pointsAge = poses.at[i].pointsAge;
  question.sinceLast = poses.at[i].sinceLast;
  question.withdrawn = 0;
  question.seal = 0;
  return question;
}

// `own`: the state that the GPU keeps.
Probe probeOf(ContactQuestion question, ContactState own, float radius) {
  Probe probe;
  probe.hip = question.pose.hip;
  const bool carried = question.carried.started != 0;
  const bool started = carried || own.started != 0;
  const vec3 lastHip = carried ? question.carried.lastHip : own.lastHip;
  const uint touching = carried ? question.carried.touching : own.touching;
  const uint face = carried ? question.carried.face : own.face;
  const vec3 facing = carried ? question.carried.facing : own.facing;
  const vec3 spring = carried ? question.carried.spring : own.spring;
  precise vec3 way = started ? lastHip - probe.hip : vec3(0.0);
  probe.velocity = vec3(0.0);
  if (kPointsMove && started) {
    const vec3 velocity = carried ? question.carried.velocity : own.velocity;
    precise vec3 moved = question.sinceLast * velocity, age = question.pointsAge * velocity;
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

// `i`: the number of the tool's point.
Probe probeOf(ContactPoses pose, ContactStates state, uint i, float radius) {
  return probeOf(questionAt(pose, i), stateAt(state, i), radius);
}

// Position of a free HIP after `substep` of its sub-steps.
vec3 placeOnWay(Probe probe, uint substep) {
  precise vec3 place = probe.lastHip * (float(probe.substeps - substep) / float(probe.substeps));
  return place;
}

vec3 firstPlace(Probe probe) { return probe.touching ? probe.proxy : placeOnWay(probe, 1); }

#endif
