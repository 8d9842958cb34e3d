// Where the probe stands when a tick begins, and the place that its first patch is gathered around. Every method has
// to find the same bits here: hence `precise`.
#ifndef PALPATE_LIB_PROBE_GLSL
#define PALPATE_LIB_PROBE_GLSL

#include "shaders/lib/contact_buffers.glsl"
#include "shaders/shared/proxy.h"

// Places relative to the HIP, but the HIP itself.
struct Probe {
  vec3 hip;  // model units relative to the cloud's origin
  vec3 lastHip;
  vec3 proxy;
  bool traced;  // the sub-steps cover the way since the last tick
  bool touching;
  bool sticking;
  uint face;
  vec3 facing;
  uint substeps;  // of a free HIP's way since the last tick
};

// `i`: which of the points that a tool touches with.
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
  probe.lastHip = started ? lastHip - probe.hip : vec3(0.0);
  probe.touching = started && touching != kFree;
  probe.sticking = touching == kSticking;
  probe.face = started ? face : kFaceUnknown;
  probe.facing = started ? facing : vec3(0.0);
  probe.proxy = probe.touching ? spring + probe.lastHip : vec3(0.0);
  precise float way = length(probe.lastHip) / (kLongestStep * radius);
  probe.traced = started && way <= float(kMaxSubsteps);
  probe.substeps = substepsOn(way);
  return probe;
}

// Where a free HIP is after `substep` of its sub-steps.
vec3 placeOnWay(Probe probe, uint substep) {
  precise vec3 place = probe.lastHip * (float(probe.substeps - substep) / float(probe.substeps));
  return place;
}

vec3 firstPlace(Probe probe) { return probe.touching ? probe.proxy : placeOnWay(probe, 1); }

#endif
