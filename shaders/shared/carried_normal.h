// The side of the surface to which a stroke has carried a normal, from the motion of the points around it. A normal
// fitted to the present points has no side of its own, and at a rim, in a fold or on a thin part most neighbours may
// face the other way.
#ifndef PALPATE_SHARED_CARRIED_NORMAL_H
#define PALPATE_SHARED_CARRIED_NORMAL_H
#include "shaders/shared/frame.h"
#include "shaders/shared/resample.h"
#include "shaders/shared/weight.h"

PALPATE_SHARED_BEGIN

// Cosine between a fitted normal and the same as the stroke found it below which its side is determined by the motion:
// above it the two agree, and a surface that has been bent by less than 60 degrees needs no second look.
const float kCarriedFar = 0.5f;
// Minimum cosine between the fitted and the carried normal: below it the motion does not determine the side.
const float kCarriedSure = 0.2f;

// The present offsets of the neighbours, weighted, times their offsets along two tangents of the surface as the stroke
// found it: up to a factor that both share, and the same linear map of the two, the images of these tangents under the
// linear deformation with the least squared error. So their cross product is along the carried normal.
PALPATE_STRUCT(CarriedTangents) {
  PALPATE_VEC3 u;
  PALPATE_VEC3 v;
};
PALPATE_SINGLE(CarriedTangents);

// A point as the stroke found it, and the tangents there.
PALPATE_STRUCT(CarriedFrom) {
  PALPATE_VEC3 position;
  PALPATE_VEC3 normal;
  PALPATE_VEC3 u;
  PALPATE_VEC3 v;
};
PALPATE_SINGLE(CarriedFrom);

PALPATE_FORMULA PALPATE_OF(CarriedFrom) carriedFrom(PALPATE_VEC3 position, PALPATE_VEC3 normal) {
  PALPATE_OF(CarriedFrom) from;
  from.position = position;
  from.normal = normal;
  frameAround(normal, from.u, from.v);
  return from;
}

// `offset`: of a neighbour, at present; `found`, `foundNormal`: as the stroke found it, or as it is if it has not
// moved.
PALPATE_FORMULA void addCarried(PALPATE_INOUT(PALPATE_OF(CarriedTangents)) tangents, PALPATE_OF(CarriedFrom) from,
                                PALPATE_VEC3 offset, PALPATE_VEC3 found, PALPATE_VEC3 foundNormal, Real radius) {
  const Real share = Real(fitShare(float(dot(foundNormal, from.normal))));
  const PALPATE_VEC3 w = share * wendland(length(offset) / radius) * offset;
  tangents.u += dot(found - from.position, from.u) * w;
  tangents.v += dot(found - from.position, from.v) * w;
}

// The carried normal, unit; zero if the points around do not determine it.
PALPATE_FORMULA PALPATE_VEC3 carriedNormal(PALPATE_OF(CarriedTangents) tangents) {
  const PALPATE_VEC3 carried = cross(tangents.u, tangents.v);
  const Real size = length(carried);
  return size > Real(0.0) ? carried / size : Real(0.0) * carried;
}

// Whether a normal is on the other side.
PALPATE_FORMULA bool isAgainst(PALPATE_VEC3 carried, PALPATE_VEC3 normal) {
  return dot(carried, normal) < Real(-kCarriedSure);
}

// A carried normal as one word, not 0. Its direction is off by 0.2 degrees at most.
PALPATE_FUNCTION uint packedCarried(vec3 carried) {
  const vec3 steps = floor(511.0f * carried + vec3(512.5f));
  return uint(steps.x) | uint(steps.y) << 10u | uint(steps.z) << 20u;
}

PALPATE_FUNCTION vec3 unpackedCarried(uint word) {
  const vec3 steps = vec3(float(word & 1023u), float(word >> 10u & 1023u), float(word >> 20u & 1023u));
  return (steps - vec3(512.0f)) / 511.0f;
}

PALPATE_SHARED_END
#endif
