// Hands that press on the surface of a soft body on a GPU (engine/matter/gpu_soft_press.hpp). A press holds nodes, in
// the order of their numbers, with their shares of its position: at most all nodes of cells with skin.
#ifndef PALPATE_SHARED_SOFT_PRESS_H
#define PALPATE_SHARED_SOFT_PRESS_H
#include "shaders/shared/soft_passes.h"

PALPATE_SHARED_BEGIN

// Each press has one invocation of a workgroup.
const uint kMaxPresses = kMatterBlock;
// vec4s of a box: its low corner, its high corner.
const uint kBoxVec4s = 2u;

// A press at the start of a step.
struct SoftPressed {
  vec3 place;  // m
  float radius;
  vec3 normal;
  float stiffness;  // N/m
  vec3 stretch;     // of its position from the hand, which has more digits than positions have, m
  float damping;    // N s/m
  vec3 move;        // of the hand in the step, m
  float friction;
  vec3 velocity;  // of the hand, m/s
  float most;     // maximum of all presses of the hand, N
  vec3 force;     // on the hand, in the substep before, N
  uint hand;
  uint row;   // of its nodes and their number, kept from step to step
  uint same;  // not 0: its nodes are those of the step before
};
PALPATE_SIZE(SoftPressed, 104);

// Result of a press. The pinned nodes have the share `pinned` of it.
struct SoftPressDone {
  vec3 force;    // on the hand, in the last substep, N
  float work;    // of the hand, J
  vec3 impulse;  // on the hand, kg m/s
  float pinned;
  vec3 moved;  // of its position, m
  uint alone;  // not 0: no skin point was in reach when its nodes were found
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

// The box around all skin points of a cell.
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

// The box around all skin points to which the nodes of a block contribute.
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

// Nodes that each press may hold; one workgroup for each.
struct SoftHoldArgs {
  PALPATE_ADDRESS(SoftPresses) presses;
  PALPATE_ADDRESS(Uints) counts;  // number of presses; then, out, number of nodes in each row
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

// Their shares; one workgroup for each press. A press without a skin point within its radius holds the nodes of the
// nearest one.
struct SoftShareArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(SoftPresses) presses;
  PALPATE_ADDRESS(Uints) counts;
  PALPATE_ADDRESS(UVec4s) incident;
  PALPATE_ADDRESS(Vec4s) boxes;
  PALPATE_ADDRESS(SoftHelds) held;
  PALPATE_ADDRESS(SoftPressesDone) done;  // out: initial values
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(UVec4s) corners;
  PALPATE_ADDRESS(SoftSkinCells) skinCells;
  PALPATE_ADDRESS(Vec4s) skin;
  PALPATE_ADDRESS(Vec4s) normals;  // of the skin points, at rest; bits of their numbers
  uint stride;
  uint skinCount;
  uint firstInner;
  uint slots;
  uint heldStride;
  uint unused;
};
PALPATE_SIZE(SoftShareArgs, 120);

// Acceleration of the position of one press by a force on another one's, or on its own: 1/kg. One workgroup for each.
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

// The presses of a substep, one workgroup, after the forces of the cells and before the nodes move: the presses change
// the velocities of the nodes.
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
  float share;    // fraction of the step that is completed at the end of the substep
  float perStep;  // fraction of the step that the substep is
};
PALPATE_SIZE(SoftPressArgs, 88);

PALPATE_SHARED_END

#endif
