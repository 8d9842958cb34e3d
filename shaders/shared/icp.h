// Where a camera stands in a map, by point-to-plane ICP (Chen and Medioni 1992; linearised as in Low 2004): one pair
// of a pixel and the point of the map that it falls on, as a row of six unknowns. Who sums up: engine/motion/icp.cpp.
#ifndef PALPATE_SHARED_ICP_H
#define PALPATE_SHARED_ICP_H
#include "shaders/shared/real.h"

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

PALPATE_SHARED_END
#endif
