// How the points of a frame go on from the time that it is true for, each with its velocity and the turn of its normal.
// A tick is taken in the frame of the surface around the hand, which goes with the mean of their velocities
// (shaders/lib/probe.glsl, engine/contact/proxy_tracker.hpp). Who moves points on: shaders/lib/patch.glsl,
// engine/touch/cpu_touch.cpp.
#ifndef PALPATE_SHARED_MOTION_H
#define PALPATE_SHARED_MOTION_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Velocities on a GPU: a vec4 for each id, model units per second, with 1 in w where nothing is known but the part
// along the surface's normal, else 0; where normals turn, as many turns follow, a second, and 0.

// A unit normal that has changed by `turn` a second for `age` seconds, before the time it is true for where that is
// negative. One that does not turn keeps every bit.
PALPATE_FORMULA PALPATE_VEC3 normalAfter(PALPATE_VEC3 normal, PALPATE_VEC3 turn, Real age) {
  const PALPATE_VEC3 change = age * turn;
  const PALPATE_VEC3 turned = normal + change;
  const Real size = length(turned);
  return dot(change, change) > Real(0.0) && size > Real(0.0) ? turned / size : normal;
}

// A place at that age, in the frame of a surface that goes with a velocity of its own.
PALPATE_FORMULA PALPATE_VEC3 placeAfter(PALPATE_VEC3 place, PALPATE_VEC3 velocity, PALPATE_VEC3 ofSurface, Real age) {
  return place + age * (velocity - ofSurface);
}

// The velocity of a surface, of which nothing is known but the part along its unit normal in so large a share of the
// points.
PALPATE_FORMULA PALPATE_VEC3 knownVelocity(PALPATE_VEC3 velocity, PALPATE_VEC3 normal, Real share) {
  return velocity - share * (velocity - dot(velocity, normal) * normal);
}

PALPATE_SHARED_END
#endif
