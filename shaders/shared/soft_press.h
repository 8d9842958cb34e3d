// Hands that press on the surface of a soft body on a GPU (engine/matter/gpu_soft_press.hpp). What a press holds are
// nodes, in the order of their numbers, with their shares of its place: at most as many as have a part in the skin.
#ifndef PALPATE_SHARED_SOFT_PRESS_H
#define PALPATE_SHARED_SOFT_PRESS_H
#include "shaders/shared/soft_passes.h"

PALPATE_SHARED_BEGIN

// Each has an invocation of one workgroup.
const uint kMaxPresses = kMatterBlock;
// vec4s of a box: its low end, its high end.
const uint kBoxVec4s = 2u;

// A press when a step begins.
struct SoftPressed {
  vec3 place;  // m
  float radius;
  vec3 normal;
  float stiffness;  // N/m
  vec3 stretch;     // of the place from the hand, which has more digits than places have, m
  float damping;    // N s/m
  vec3 move;        // of the hand in the step, m
  float friction;
  vec3 velocity;  // of the hand, m/s
  float most;     // N, of all presses of the hand
  vec3 force;     // on the hand, in the substep before, N
  uint hand;
  uint row;   // where its nodes stand, and their number, from step to step
  uint same;  // not 0: they are those of the step before
};
PALPATE_SIZE(SoftPressed, 104);

// What came of it. The nodes that are pinned have the share `pinned` of it.
struct SoftPressDone {
  vec3 force;    // on the hand, in the last substep, N
  float work;    // of the hand, J
  vec3 impulse;  // on the hand, kg m/s
  float pinned;
  vec3 moved;  // of the place, m
  uint alone;  // not 0: no place of the skin was in reach when its nodes were found
};
PALPATE_SIZE(SoftPressDone, 48);

// A node that a press holds.
struct SoftHeld {
  uint node;
  float share;
};
PALPATE_SIZE(SoftHeld, 8);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SoftPresses { SoftPressed at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SoftPressesDone { SoftPressDone at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer SoftHelds { SoftHeld at[]; };
// Nodes that several presses move one after another.
layout(buffer_reference, scalar, buffer_reference_align = 16) coherent buffer SoftMovedNodes { vec4 at[]; };
#endif

// The box in which all places of the skin are that a cell has.
struct SoftBoxArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(UVec4s) corners;
  PALPATE_ADDRESS(SoftSkinCells) skinCells;
  PALPATE_ADDRESS(Vec4s) boxes;  // out: by slot
  uint skinCount;
  uint firstInner;
  uint slots;
  uint unused;
};
PALPATE_SIZE(SoftBoxArgs, 56);

// The box of all places of the skin in which the nodes of a block have a part.
struct SoftReachArgs {
  PALPATE_ADDRESS(UVec4s) incident;
  PALPATE_ADDRESS(Vec4s) boxes;
  PALPATE_ADDRESS(Vec4s) blockBoxes;  // out
  uint nodeCount;
  uint stride;
  uint skinCount;
  uint unused;
};
PALPATE_SIZE(SoftReachArgs, 40);

// Which nodes each press may hold; a workgroup for each.
struct SoftHoldArgs {
  PALPATE_ADDRESS(SoftPresses) presses;
  PALPATE_ADDRESS(Uints) counts;  // how many presses there are; then, out, how many nodes each row holds
  PALPATE_ADDRESS(UVec4s) incident;
  PALPATE_ADDRESS(Vec4s) boxes;
  PALPATE_ADDRESS(Vec4s) blockBoxes;
  PALPATE_ADDRESS(SoftHelds) held;  // out, in rows
  uint nodeCount;
  uint stride;
  uint skinCount;
  uint blocks;
  uint heldStride;
  uint unused;
};
PALPATE_SIZE(SoftHoldArgs, 72);

// Their shares; a workgroup for each press. Where the press has no place of the skin within its radius, it holds the
// nodes of the nearest one.
struct SoftShareArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(SoftPresses) presses;
  PALPATE_ADDRESS(Uints) counts;
  PALPATE_ADDRESS(UVec4s) incident;
  PALPATE_ADDRESS(Vec4s) boxes;
  PALPATE_ADDRESS(SoftHelds) held;
  PALPATE_ADDRESS(SoftPressesDone) done;  // out: as it begins
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(UVec4s) corners;
  PALPATE_ADDRESS(SoftSkinCells) skinCells;
  PALPATE_ADDRESS(Vec4s) skin;
  PALPATE_ADDRESS(Vec4s) normals;  // of the places of the skin, at rest; bits of their numbers
  uint stride;
  uint skinCount;
  uint firstInner;
  uint slots;
  uint heldStride;
  uint unused;
};
PALPATE_SIZE(SoftShareArgs, 120);

// How much the place of one press is accelerated by a force on another one's, or on its own: 1/kg. A workgroup for
// each.
struct SoftCoupleArgs {
  PALPATE_ADDRESS(SoftPresses) presses;
  PALPATE_ADDRESS(Uints) counts;
  PALPATE_ADDRESS(SoftHelds) held;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(Floats) coupling;  // out: rows of kMaxPresses
  uint heldStride;
  uint unused;
};
PALPATE_SIZE(SoftCoupleArgs, 48);

// The presses of a substep, one workgroup, behind what cells do and before nodes move: the nodes get what presses do to
// them in their velocities.
struct SoftPressArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(SoftPresses) presses;
  PALPATE_ADDRESS(Uints) counts;
  PALPATE_ADDRESS(SoftHelds) held;
  PALPATE_ADDRESS(Floats) coupling;
  PALPATE_ADDRESS(SoftPressesDone) done;
  PALPATE_ADDRESS(SoftMovedNodes) nodes;
  PALPATE_ADDRESS(UVec4s) incident;
  PALPATE_ADDRESS(Floats) forces;
  uint stride;
  uint heldStride;
  float share;    // of the step that is over at the end of the substep
  float perStep;  // the substep, of the step
};
PALPATE_SIZE(SoftPressArgs, 88);

PALPATE_SHARED_END

#endif
