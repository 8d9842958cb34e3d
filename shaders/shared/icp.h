// Where a camera stands in a map, by point-to-plane ICP (Chen and Medioni 1992; linearised as in Low 2004): one pair
// of a pixel and the point of the map that it falls on, as a row of six unknowns. Who sums up: engine/motion/icp.cpp.
#ifndef PALPATE_SHARED_ICP_H
#define PALPATE_SHARED_ICP_H
#include "shaders/shared/fusion.h"

PALPATE_SHARED_BEGIN

// The least cosine between the normals of a pair.
const float kPairedNormals = 0.7f;
// In deviations of the noise: from here on a residual pulls no harder (Huber 1964).
const float kHuberDeviations = 1.5f;

PALPATE_STRUCT(IcpPair) {
  bool isPair;
  PALPATE_VEC3 turn;   // what a rotation about the pivot adds to the residual, per rad and unit of `scale`
  PALPATE_VEC3 shift;  // what a translation adds: the normal
  Real residual;       // along the normal, m
  Real weight;         // 1 / m^2
};
PALPATE_SINGLE(IcpPair);

PALPATE_FORMULA Real huberWeight(Real residual, Real deviation) {
  const Real most = Real(kHuberDeviations) * deviation;
  return min(Real(1.0), most / max(abs(residual), Real(1e-12)));
}

// `measured` and `normal` of a pixel, `place` and `placeNormal` of the map's point; all in one system. Farther apart
// than `gate` they are no pair.
PALPATE_FORMULA PALPATE_OF(IcpPair)
    icpPair(PALPATE_VEC3 measured, PALPATE_VEC3 normal, PALPATE_VEC3 place, PALPATE_VEC3 placeNormal,
            PALPATE_VEC3 pivot, Real scale, Real gate, Real deviation) {
  PALPATE_OF(IcpPair) pair;
  const PALPATE_VEC3 offset = measured - place;
  pair.isPair = dot(offset, offset) <= gate * gate && dot(normal, placeNormal) >= Real(kPairedNormals);
  pair.turn = cross(measured - pivot, placeNormal) / scale;
  pair.shift = placeNormal;
  pair.residual = dot(placeNormal, offset);
  pair.weight = huberWeight(pair.residual, deviation) / (deviation * deviation);
  return pair;
}

// Whether a point of the map may be the one in front in its pixel.
PALPATE_FUNCTION bool isFront(FusionView view, Projection projection, vec3 normal) {
  return projection.inView && dot(directionInCamera(view, normal), projection.place) < 0.0f;
}

// The variance, in one direction, of the normal of a point whose measurements weigh `weight`, seen at `depth`: that of a
// slope over the square of pixels that a plane is fitted to, less by how often it was measured.
PALPATE_FUNCTION float normalVariance(FusionView view, float depth, float weight) {
  const float side = float(2 * kFitReach + 1);
  const float squares = side * side * (side * side - 1.0f) / 12.0f;  // sum of x^2 over the square
  const float footprint = depth / min(view.camera.fx, view.camera.fy);
  const float slope = depthDeviation(view.noise, depth) / footprint;
  return slope * slope / squares * min(1.0f, measurementWeight(view, depth) / weight);
}

PALPATE_SHARED_END
#endif
