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

// What a pair is made of: a place and its normal.
PALPATE_STRUCT(Oriented) {
  PALPATE_VEC3 place;
  PALPATE_VEC3 normal;  // unit
};
PALPATE_SINGLE(Oriented);

// How pairs are made: rotations are about the pivot, and an angle times `scale` is the unknown; what is farther apart
// than the gate is no pair.
PALPATE_STRUCT(Pairing) {
  PALPATE_VEC3 pivot;
  Real scale;
  Real gate;
};
PALPATE_SINGLE(Pairing);

// Of what a pixel sees, with the deviation of its depth, and a point of the map; all in one system.
PALPATE_FORMULA PALPATE_OF(IcpPair)
    icpPair(PALPATE_OF(Oriented) seen, PALPATE_OF(Oriented) mapped, PALPATE_OF(Pairing) pairing, Real deviation) {
  PALPATE_OF(IcpPair) pair;
  const PALPATE_VEC3 offset = seen.place - mapped.place;
  const bool isNear = dot(offset, offset) <= pairing.gate * pairing.gate;
  pair.isPair = isNear && dot(seen.normal, mapped.normal) >= Real(kPairedNormals);
  pair.turn = cross(seen.place - pairing.pivot, mapped.normal) / pairing.scale;
  pair.shift = mapped.normal;
  pair.residual = dot(mapped.normal, offset);
  pair.weight = huberWeight(pair.residual, deviation) / (deviation * deviation);
  return pair;
}

// Whether a point of the map may be the one in front in its pixel.
PALPATE_FUNCTION bool isFront(FusionView view, Projection projection, vec3 normal) {
  return projection.inView && dot(directionInCamera(view, normal), projection.place) < 0.0f;
}

// The variance, in one direction, of the normal of a point whose measurements weigh `weight`, seen at `depth`: that of
// a slope over the square of pixels that a plane is fitted to, less by how often it was measured.
PALPATE_FUNCTION float normalVariance(FusionView view, float depth, float weight) {
  const float squares = squaresWithin(float(fitReach(view.sensor, depth)));
  return slopeVariance(view.sensor, depth) / squares * min(1.0f, measurementWeight(view, depth) / weight);
}

PALPATE_SHARED_END
#endif
