// The implicit surface that the points define around a position, from weighted sums over its neighbours. Three kinds
// (SurfaceKind): the weighted average (Leeper, Chan, Salisbury 2012; Adamson and Alexa 2003), the algebraic sphere
// fitted to positions and normals (Guennebaud and Gross 2007; in closed form Guennebaud, Germann, Gross 2008), and that
// sphere with weights that drop points across an edge (Oztireli, Guennebaud, Gross 2009). Sums are relative to the
// position and in support radii, so that small differences keep their precision. The summation is in
// shaders/lib/surface.glsl, engine/contact/surface.hpp (double precision) and engine/cuda/surface.cuh.
#ifndef PALPATE_SHARED_SURFACE_H
#define PALPATE_SHARED_SURFACE_H
#include "shaders/shared/contact.h"
#include "shaders/shared/weight.h"

PALPATE_SHARED_BEGIN

PALPATE_STRUCT(Surface) {
  bool defined;
  Real distance;        // signed, model units, positive outside
  PALPATE_VEC3 normal;  // unit
  uint neighbours;
  bool ends;  // not defined because all neighbours lie to one side: the position is past the rim of a sheet
};

PALPATE_STRUCT(SurfaceSums) {
  PALPATE_VEC4 offsets;   // sum of w d, sum of w; d from the position to a neighbour, support radii
  PALPATE_VEC4 normals;   // sum of w n, neighbours
  PALPATE_VEC2 products;  // sum of w d.d, sum of w d.n
};

// Weight of a neighbour by how well it fits the surface of the previous pass, whose unit normal and distance (in
// support radii) are given; `d` and `n`: the neighbour's offset in support radii and its normal.
PALPATE_FORMULA Real robustWeight(PALPATE_VEC3 normalBefore, Real distanceBefore, PALPATE_VEC3 d, PALPATE_VEC3 n) {
  const PALPATE_VEC3 turn = (n - normalBefore) / Real(kSharpNormal);
  const Real height = (-dot(d, n) - distanceBefore) / Real(kSharpHeight);
  return exp(-dot(turn, turn) - height * height);
}

// Weight of a normal when the bending of a surface of this kind (kSurface...) is estimated; `cosine`: between it and
// the felt face.
PALPATE_FORMULA Real turnWeight(uint kind, Real cosine) {
  if (kind == kSurfaceSharp) return smoothstep(Real(kAcrossEdge), Real(kThisFace), cosine);
  return facingWeight(cosine);
}

// The support radius that holds kSupportSpacings local spacings, if the weights within `radius` sum up to `weights`.
PALPATE_FORMULA Real localRadius(Real radius, Real weights, Real smallest, Real largest) {
  const Real spacing = spacingFrom(radius, max(weights, Real(1e-30)));
  return clamp(Real(kSupportSpacings) * spacing, smallest, largest);
}

// The support radius between a narrow and a wide one, by the length `meanNormal` of the weighted mean normal within the
// wide one: wide where the normals agree.
PALPATE_FORMULA Real wideWhereFlat(Real narrow, Real wide, Real meanNormal) {
  return lerp(wide, narrow, smoothstep(Real(kFlatTurn), Real(kFoldTurn), Real(1.0) - meanNormal));
}

// The zero set of u(y) = u0 + ul.y + u4 y.y, y relative to the position: a sphere, or a plane if u4 = 0. `spread` and
// `turn`: the weighted variance of the offsets, and their covariance with the normals.
PALPATE_FORMULA void fitSphere(PALPATE_OF(SurfaceSums) sums, Real spread, Real turn,
                               PALPATE_INOUT(PALPATE_OF(Surface)) surface) {
  const Real weights = sums.offsets.w;
  const PALPATE_VEC3 offsets = PALPATE_VEC3(sums.offsets);
  const Real strongest = Real(0.5) * Real(kStrongestCurvature);
  const Real u4 = clamp(Real(0.5) * turn / (spread + Real(kMinSpread)), -strongest, strongest);
  const PALPATE_VEC3 ul = (PALPATE_VEC3(sums.normals) - Real(2.0) * u4 * offsets) / weights;
  const Real u0 = -(dot(ul, offsets) + u4 * sums.products.x) / weights;
  const Real slope = length(ul);
  surface.defined = slope > Real(kMinNormal);
  if (!surface.defined) return;
  surface.normal = ul / slope;
  // The nearer root, in the form that does not cancel if the sphere is almost a plane.
  surface.distance = Real(2.0) * u0 / (slope + sqrt(max(Real(0.0), slope * slope - Real(4.0) * u0 * u4)));
}

// `kind`: kSurface...; `spread` and `turn`: as for fitSphere().
PALPATE_FORMULA PALPATE_OF(Surface)
    surfaceFrom(PALPATE_OF(SurfaceSums) sums, Real spread, Real turn, Real radius, uint kind) {
  PALPATE_OF(Surface) none;
  none.defined = false;
  none.distance = Real(0.0);
  none.normal = PALPATE_VEC3(Real(0.0));
  none.neighbours = uint(sums.normals.w);
  none.ends = false;
  const Real normalLength = length(PALPATE_VEC3(sums.normals));
  // Written so that a NaN does not give a surface.
  if (none.neighbours < kMinNeighbours || !(normalLength > Real(kMinNormal) * sums.offsets.w)) return none;
  PALPATE_OF(Surface) surface = none;
  const PALPATE_VEC3 mean = PALPATE_VEC3(sums.offsets) / sums.offsets.w;
  surface.defined = true;
  surface.normal = PALPATE_VEC3(sums.normals) / normalLength;
  surface.distance = -dot(surface.normal, mean);
  if (kind != kSurfaceAverage) fitSphere(sums, spread, turn, surface);
  const PALPATE_VEC3 aside = mean - dot(mean, surface.normal) * surface.normal;
  none.ends = length(aside) >= Real(kFurthestAside);
  if (!surface.defined || none.ends) return none;
  surface.distance *= radius;
  return surface;
}

// With `spread` and `turn` computed from the sums.
PALPATE_FORMULA PALPATE_OF(Surface) surfaceFrom(PALPATE_OF(SurfaceSums) sums, Real radius, uint kind) {
  const Real weights = sums.offsets.w;
  const PALPATE_VEC3 offsets = PALPATE_VEC3(sums.offsets);
  const Real spread = sums.products.x / weights - dot(offsets, offsets) / (weights * weights);
  const Real turn = sums.products.y / weights - dot(offsets, PALPATE_VEC3(sums.normals)) / (weights * weights);
  return surfaceFrom(sums, spread, turn, radius, kind);
}

PALPATE_SHARED_END
#endif
