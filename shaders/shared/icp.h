// Pose of a camera in a map, by point-to-plane ICP (Chen and Medioni 1992; linearised as in Low 2004): one pair of a
// pixel and the map point that it sees, as a row of six unknowns. The sums over pairs are in engine/motion/icp.cpp.
#ifndef PALPATE_SHARED_ICP_H
#define PALPATE_SHARED_ICP_H
#include "shaders/shared/fusion.h"

PALPATE_SHARED_BEGIN

// Minimum cosine between the normals of a pair.
const float kPairedNormals = 0.7f;
// In standard deviations of the noise: above this a residual pulls no harder (Huber 1964).
const float kHuberDeviations = 1.5f;

PALPATE_STRUCT(IcpPair) {
  bool isPair;
  PALPATE_VEC3 turn;   // change of the residual by a rotation about the pivot, per rad and unit of `scale`
  PALPATE_VEC3 shift;  // change of the residual by a translation: the normal
  Real residual;       // along the normal, m
  Real weight;         // 1 / m^2
};
PALPATE_SINGLE(IcpPair);

PALPATE_FORMULA Real huberWeight(Real residual, Real deviation) {
  const Real most = Real(kHuberDeviations) * deviation;
  return min(Real(1.0), most / max(abs(residual), Real(1e-12)));
}

// One side of a pair: a position and its normal.
PALPATE_STRUCT(Oriented) {
  PALPATE_VEC3 place;
  PALPATE_VEC3 normal;  // unit
};
PALPATE_SINGLE(Oriented);

// How pairs are made: rotations are about the pivot, and an angle times `scale` is the unknown. Two positions farther
// apart than the gate are not a pair.
PALPATE_STRUCT(Pairing) {
  PALPATE_VEC3 pivot;
  Real scale;
  Real gate;
};
PALPATE_SINGLE(Pairing);

// The pair of a pixel's surface, with the standard deviation of its depth, and a point of the map; both in one
// coordinate system.
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

// Whether a point of the map may be the front one in its pixel.
PALPATE_FUNCTION bool isFront(FusionView view, Projection projection, vec3 normal) {
  return projection.inView && dot(directionInCamera(view, normal), projection.place) < 0.0f;
}

// Variance, in one direction, of the normal of a point whose measurements weigh `weight`, seen at `depth`: that of a
// slope divided by the sum of squares of the fitted pixels, reduced by the number of measurements.
PALPATE_FUNCTION float normalVariance(FusionView view, float depth, float weight) {
  const float squares = squaresWithin(float(fitReach(view.sensor, depth)));
  return slopeVariance(view.sensor, depth) / squares * min(1.0f, measurementWeight(view, depth) / weight);
}

PALPATE_SHARED_END
#endif
