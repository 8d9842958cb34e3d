// How a soft body on a GPU gives way to a small force: conjugate gradients (Hestenes, Stiefel 1952) with the body's
// stiffness, as differences of what its cells and the walls do to the nodes (engine/matter/gpu_soft_compliance.hpp).
#ifndef PALPATE_SHARED_SOFT_DESCENT_H
#define PALPATE_SHARED_SOFT_DESCENT_H
#include "shaders/shared/soft_passes.h"

PALPATE_SHARED_BEGIN

// Vectors of a vec4 a node, one behind another: the way that is tried; what the body answers to it; what is left of the
// load; how far the nodes have moved.
const uint kWayVector = 0u;
const uint kAnswerVector = 1u;
const uint kLeftVector = 2u;
const uint kMovedVector = 3u;
const uint kDescentVectors = 4u;
// Rows of sums over blocks of nodes: of the squares of what is left, before even and before odd rounds; of the way
// times the answer; the longest part of the way, squared, which is no sum and stands in w; of the load times how far it
// has moved.
const uint kLeftRow = 0u;
const uint kAnswerRow = 2u;
const uint kLongestRow = 3u;
const uint kMovedRow = 4u;
const uint kDescentRows = 5u;
// Of differences, in spacings: strains of about so much are resolved by single precision.
const float kTrialStrain = 1e-3f;

// Of all four passes.
struct SoftDescentArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(Vec4s) trial;  // nodes that have gone a little further, at rest
  PALPATE_ADDRESS(Vec4s) load;
  PALPATE_ADDRESS(Vec4s) vectors;
  PALPATE_ADDRESS(Vec4s) sums;
  PALPATE_ADDRESS(UVec4s) incident;
  PALPATE_ADDRESS(Floats) forces;
  uint nodeCount;
  uint stride;
  uint blocks;
  uint round;
  uint begins;  // before the first round
  float sign;   // of a trial: 1, then -1
  float hold;   // what holds a body that nothing else does, 1/s^2
  uint unused;
};
PALPATE_SIZE(SoftDescentArgs, 96);

PALPATE_SHARED_END

#endif
