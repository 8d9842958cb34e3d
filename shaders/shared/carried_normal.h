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
// Maximum of carriedSide() at which the surface has been turned over: nearer to 0 the motion does not determine it.
const float kTurnedOver = -0.5f;

// Weighted sums over a point, whose own weight is 1, and its neighbours: of their positions in the tangent plane as the
// stroke found them (a) and in the present one (b), from the point, and of products of these.
PALPATE_STRUCT(CarriedSums) {
  PALPATE_VEC4 means;     // au, av, bu, bv
  PALPATE_VEC4 products;  // au bu, au bv, av bu, av bv
  PALPATE_VEC3 found;     // au au, au av, av av
  PALPATE_VEC3 present;   // bu bu, bu bv, bv bv
  Real weight;
};
PALPATE_SINGLE(CarriedSums);

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

// `offset`: of a neighbour, at present, and two axes of the present tangent plane; `found`, `foundNormal`: as the
// stroke found it, or as it is if it has not moved.
PALPATE_FORMULA void addCarried(PALPATE_INOUT(PALPATE_OF(CarriedSums)) sums, PALPATE_OF(CarriedFrom) from,
                                PALPATE_VEC3 offset, PALPATE_VEC3 u, PALPATE_VEC3 v, PALPATE_VEC3 found,
                                PALPATE_VEC3 foundNormal, Real radius) {
  const Real weight = Real(fitShare(float(dot(foundNormal, from.normal)))) * wendland(length(offset) / radius);
  const Real au = dot(found - from.position, from.u), av = dot(found - from.position, from.v);
  const Real bu = dot(offset, u), bv = dot(offset, v);
  sums.means += weight * PALPATE_VEC4(au, av, bu, bv);
  sums.products += weight * PALPATE_VEC4(au * bu, au * bv, av * bu, av * bv);
  sums.found += weight * PALPATE_VEC3(au * au, au * av, av * av);
  sums.present += weight * PALPATE_VEC3(bu * bu, bu * bv, bv * bv);
  sums.weight += weight;
}

// The product of the two canonical correlations (Hotelling 1936) of the positions as found and at present, negative if
// the motion has turned the surface over: 1 for a linear deformation, -1 for one of the other side, and near 0 where
// the motion does not determine the side, as on the wall of a deep dent, to which a ring without width was stretched.
PALPATE_FORMULA Real carriedSide(PALPATE_OF(CarriedSums) sums) {
  const Real m = Real(1.0) / max(sums.weight, Real(1e-30));
  const Real au = sums.means.x, av = sums.means.y, bu = sums.means.z, bv = sums.means.w;
  const PALPATE_VEC3 found = sums.found - m * PALPATE_VEC3(au * au, au * av, av * av);
  const PALPATE_VEC3 present = sums.present - m * PALPATE_VEC3(bu * bu, bu * bv, bv * bv);
  const PALPATE_VEC4 products = sums.products - m * PALPATE_VEC4(au * bu, au * bv, av * bu, av * bv);
  const Real areas = sqrt(max(Real(0.0), found.x * found.z - found.y * found.y)) *
                     sqrt(max(Real(0.0), present.x * present.z - present.y * present.y));
  return areas > Real(0.0) ? (products.x * products.w - products.y * products.z) / areas : Real(0.0);
}

// Whether a normal is on the other side than the carried one.
PALPATE_FORMULA bool isAgainst(PALPATE_VEC3 carried, PALPATE_VEC3 normal) { return dot(carried, normal) < Real(0.0); }

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
