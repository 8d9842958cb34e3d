// What the passes of a soft body on a GPU read and write (engine/matter/soft_passes.hpp). Its cells are in slots: first
// those with skin points, which take longest, then, from a whole block on, those without. Arrays by slot and by corner
// or axis are in planes of `stride` floats, one after another; after the last slot is one without a cell, where all
// planes are 0.
#ifndef PALPATE_SHARED_SOFT_PASSES_H
#define PALPATE_SHARED_SOFT_PASSES_H
#include "shaders/shared/matter_state.h"
#include "shaders/shared/soft.h"

PALPATE_SHARED_BEGIN

// vec4s of a node: its displacement from rest (m) and its mass (kg); its velocity (m/s) and whether it is free (1) or
// pinned (0).
const uint kNodeVec4s = 2u;
// uvec4s of a node: indices, in the planes of forces, of the x forces on it by the eight cells around it.
const uint kIncidentUVec4s = 2u;
// vec4s of a skin point: its share of the cell along each axis and its stiffness (N/m); its position at rest (m).
const uint kSkinVec4s = 2u;
// vec4s of a node's gradient, one for each column.
const uint kGradientVec4s = 3u;
// Planes of the forces, x, y and z of each corner, and of the gradients.
const uint kForcePlanes = 24u;
const uint kGradientPlanes = 9u;
// Rows of sums: impulse on walls and pins, and the kinetic energy; momentum and the maximum compression; then for each
// tool its impulse, and its angular impulse.
const uint kSoftRowsOfAll = 2u;

// Constants of all cells and nodes.
struct SoftSetting {
  SoftRules rules;
  ToolSpring spring;
  vec3 box;       // walls are at 0 and at this, m
  float ball;     // radius of the balls, m
  vec3 fall;      // velocity change by gravity in a substep, m/s
  float step;     // s
  float spacing;  // m
  float beyond;   // how far a skin point may be outside its cell, as a share of the cell's extent
  float damping;  // of a contact, per stiffness, s
  float friction;
  float carriedSpeed;  // factor on the velocities of carried points: 1, or 0 while all is held
};
PALPATE_SIZE(SoftSetting, 100);

// A cell with skin points, in the order of the slots; one more at the end marks the end of the last points.
struct SoftSkinCell {
  vec3 corner;  // its lowest corner at rest, m
  uint first;   // of its skin points
};
PALPATE_SIZE(SoftSkinCell, 16);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Floats { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SoftSettings { SoftSetting now; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer SoftSkinCells { SoftSkinCell at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CellRests { CellRest at[]; };
#endif

// Predicts the balls of tools for the end of the first substep, before the other passes.
struct SoftPredictArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(HandSteps) hands;  // substep by substep
  PALPATE_ADDRESS(ToolStates) tools;
  uint toolCount;
  uint unused;
};
PALPATE_SIZE(SoftPredictArgs, 32);

// Forces of each cell on its nodes, including those of walls and balls on its skin points.
struct SoftCellsArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(UVec4s)
  corners;  // nodes of corners 0, 2, 4 and 6 of each slot; the nodes after them are corners 1, 3, 5 and 7
  PALPATE_ADDRESS(Floats) volumes;  // of the matter in each slot, m^3
  PALPATE_ADDRESS(Floats) forces;   // out: planes, N
  PALPATE_ADDRESS(SoftSkinCells) skinCells;
  PALPATE_ADDRESS(Vec4s) skin;
  PALPATE_ADDRESS(ToolStates) tools;
  PALPATE_ADDRESS(Vec4s) sums;       // out: rows of blocks of slots
  PALPATE_ADDRESS(CellRests) rests;  // of each slot; without a volume: a cube; null if all are cubes
  PALPATE_ADDRESS(Vec4s) present;    // the present nodes, for a trial
  uint skinCount;                    // cells with skin points
  uint firstInner;                   // slot of the first one without
  uint slots;
  uint stride;
  uint blocks;
  uint toolCount;
  uint begins;  // whether the substep is the first of its step
  uint ends;    // whether it is the last
};
PALPATE_SIZE(SoftCellsArgs, 120);

// Moves the nodes; one additional workgroup, the first one, applies the forces on the tools, and predicts them.
struct SoftNodesArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(UVec4s) incident;
  PALPATE_ADDRESS(Floats) forces;
  PALPATE_ADDRESS(Vec4s) sums;  // out: rows of blocks of nodes
  PALPATE_ADDRESS(Vec4s) cellSums;
  PALPATE_ADDRESS(HandSteps) hands;
  PALPATE_ADDRESS(ToolStates) tools;
  uint nodeCount;
  uint stride;
  uint blocks;
  uint cellBlocks;
  uint skinBlocks;  // of the cells' blocks, those with skin
  uint toolCount;
  uint hasPins;
  uint substep;
  uint ends;
  uint unused;
};
PALPATE_SIZE(SoftNodesArgs, 104);

// The end of a step, one workgroup: the sums of all blocks.
struct SoftFinishArgs {
  PALPATE_ADDRESS(Vec4s) cellSums;
  PALPATE_ADDRESS(Vec4s) nodeSums;
  PALPATE_ADDRESS(MatterSumsAt) total;
  uint cellBlocks;
  uint nodeBlocks;
};
PALPATE_SIZE(SoftFinishArgs, 32);

// Gradient of the displacements in each cell, weighted by its volume.
struct SoftStrainArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(UVec4s) corners;
  PALPATE_ADDRESS(Floats) volumes;
  PALPATE_ADDRESS(Floats) gradients;  // out: planes, times the volume
  uint skinCount;
  uint firstInner;
  uint slots;
  uint stride;
};
PALPATE_SIZE(SoftStrainArgs, 56);

// Weighted mean of the gradients of the cells around each node.
struct SoftBlendArgs {
  PALPATE_ADDRESS(UVec4s) incident;
  PALPATE_ADDRESS(Floats) volumes;
  PALPATE_ADDRESS(Floats) gradients;
  PALPATE_ADDRESS(Vec4s) nodeGradients;  // out
  uint nodeCount;
  uint stride;
};
PALPATE_SIZE(SoftBlendArgs, 40);

// Positions of the points that the body carries.
struct SoftCarryArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(Vec4s) nodeGradients;
  PALPATE_ADDRESS(UVec4s) corners;
  PALPATE_ADDRESS(Vec4s) rests;         // position at rest of each, m; bits of the slot of its cell
  PALPATE_ADDRESS(Vec4s) shares;        // of the cell along each axis; x of the normal at rest
  PALPATE_ADDRESS(UVec2s) normalRests;  // bits of y and z
  PALPATE_ADDRESS(Vec4s) positions;     // out, like the next two, as in a live cloud; bits of the id
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Vec4s) velocities;  // by id
  uint points;
  float unitsPerMetre;  // of the output
  vec3 origin;          // of the output, in its units
  uint unused;
};
PALPATE_SIZE(SoftCarryArgs, 104);

PALPATE_SHARED_END

#endif
