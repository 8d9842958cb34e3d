// Extrapolation of the points of a frame from the time of the frame, each by its velocity and the rate of its normal. A
// tick is taken in the frame of the surface around the hand, which moves with the mean of their velocities
// (shaders/lib/probe.glsl, engine/contact/proxy_tracker.hpp). Points are extrapolated by shaders/lib/patch.glsl and
// engine/touch/cpu_touch.cpp.
#ifndef PALPATE_SHARED_MOTION_H
#define PALPATE_SHARED_MOTION_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Velocities on a GPU: a vec4 for each id, model units per second, with 1 in w if only the part along the surface's
// normal is known, else 0; if normals change, as many vec4 with their rates per second follow, with 0 in w.

// A unit normal that changes by `turn` a second, after `age` seconds; before, if that is negative. Without a change
// every bit is kept.
PALPATE_FORMULA PALPATE_VEC3 normalAfter(PALPATE_VEC3 normal, PALPATE_VEC3 turn, Real age) {
  const PALPATE_VEC3 change = age * turn;
  const PALPATE_VEC3 turned = normal + change;
  const Real size = length(turned);
  return dot(change, change) > Real(0.0) && size > Real(0.0) ? turned / size : normal;
}

// A position at that age, in the frame of a surface that moves with a velocity of its own.
PALPATE_FORMULA PALPATE_VEC3 placeAfter(PALPATE_VEC3 place, PALPATE_VEC3 velocity, PALPATE_VEC3 ofSurface, Real age) {
  return place + age * (velocity - ofSurface);
}

// The velocity of a surface, if for this share of its points only the part along the unit normal is known.
PALPATE_FORMULA PALPATE_VEC3 knownVelocity(PALPATE_VEC3 velocity, PALPATE_VEC3 normal, Real share) {
  return velocity - share * (velocity - dot(velocity, normal) * normal);
}

PALPATE_SHARED_END
#endif
