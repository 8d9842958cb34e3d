// Compliance of a soft body on a GPU, its displacement under a small force: conjugate gradients (Hestenes, Stiefel
// 1952) with the body's stiffness, from differences of the forces of its cells and the walls on the nodes
// (engine/matter/gpu_soft_compliance.hpp).
#ifndef PALPATE_SHARED_SOFT_DESCENT_H
#define PALPATE_SHARED_SOFT_DESCENT_H
#include "shaders/shared/soft_passes.h"

PALPATE_SHARED_BEGIN

// Vectors of one vec4 for each node, one after another: the search direction; the body's response to it; the residual
// of the load; the displacement of the nodes.
const uint kWayVector = 0u;
const uint kAnswerVector = 1u;
const uint kLeftVector = 2u;
const uint kMovedVector = 3u;
const uint kDescentVectors = 4u;
// Rows of sums over blocks of nodes: of the squared residual, before even and before odd rounds; of the direction times
// the response; the squared maximum of the direction over the nodes, which is not a sum and is in w; of the load times
// the displacement.
const uint kLeftRow = 0u;
const uint kAnswerRow = 2u;
const uint kLongestRow = 3u;
const uint kMovedRow = 4u;
const uint kDescentRows = 5u;
// Size of the finite differences, in spacings: single precision resolves strains of about this size.
const float kTrialStrain = 1e-3f;

// Arguments of all four passes.
struct SoftDescentArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(Vec4s) trial;  // nodes displaced by a small step, with zero velocity
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
  float hold;   // stiffness per mass that holds an otherwise free body, 1/s^2
  uint unused;
};
PALPATE_SIZE(SoftDescentArgs, 96);

PALPATE_SHARED_END

#endif
