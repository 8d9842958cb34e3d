// What the passes of a soft body on a GPU read and write (engine/matter/soft_passes.hpp). Its cells stand in slots:
// first those with a place of the skin, which take longest, then, from a whole block on, those without. What is by slot
// and by corner or axis stands in planes of `stride` floats, one behind the other; behind the last slot is one that is
// no cell, where all planes are 0.
#ifndef PALPATE_SHARED_SOFT_PASSES_H
#define PALPATE_SHARED_SOFT_PASSES_H
#include "shaders/shared/matter_state.h"
#include "shaders/shared/soft.h"

PALPATE_SHARED_BEGIN

// vec4s of a node: how far it is from rest (m) and its mass (kg); its velocity (m/s) and whether it is free (1) or
// pinned (0).
const uint kNodeVec4s = 2u;
// uvec4s of a node: the words of the planes of forces where the eight cells about it say what they do along x.
const uint kIncidentUVec4s = 2u;
// vec4s of a place of the skin: its share of the cell along each axis and its stiffness (N/m); where it rests (m).
const uint kSkinVec4s = 2u;
// vec4s of a node's gradient, a column each.
const uint kGradientVec4s = 3u;
// Planes of the forces, x, y and z of each corner, and of the gradients.
const uint kForcePlanes = 24u;
const uint kGradientPlanes = 9u;
// Rows of sums: what holds the body got and the kinetic energy; momentum and the most compression; then for each tool
// the impulse it got, and the angular one.
const uint kSoftRowsOfAll = 2u;

// What is the same for all cells and nodes.
struct SoftSetting {
  SoftRules rules;
  ToolSpring spring;
  vec3 box;       // walls from 0 to there, m
  float ball;     // radius of the balls, m
  vec3 fall;      // what gravity adds to a velocity in a substep, m/s
  float step;     // s
  float spacing;  // m
  float beyond;   // so far a place of the skin may be beyond its cell, as a share of the cell's extent
  float damping;  // of a touch, of its stiffness, s
  float friction;
  float carriedSpeed;  // share of their velocities that points are carried with: 1, or 0 while all is held
};
PALPATE_SIZE(SoftSetting, 100);

// A cell with places of the skin, in the order of the slots; one more at the end says where the last ones end.
struct SoftSkinCell {
  vec3 corner;  // the lowest one at rest, m
  uint first;   // of its places
};
PALPATE_SIZE(SoftSkinCell, 16);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Floats { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SoftSettings { SoftSetting now; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer SoftSkinCells { SoftSkinCell at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CellRests { CellRest at[]; };
#endif

// The balls of tools at the end of the first substep, before the others.
struct SoftPredictArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(HandSteps) hands;  // substep by substep
  PALPATE_ADDRESS(ToolStates) tools;
  uint toolCount;
  uint unused;
};
PALPATE_SIZE(SoftPredictArgs, 32);

// What each cell does to its nodes, with what walls and balls do to the places of the skin in it.
struct SoftCellsArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(UVec4s) corners;  // of each slot: the nodes of corners 0, 2, 4 and 6; next to them are 1, 3, 5 and 7
  PALPATE_ADDRESS(Floats) volumes;  // of what is in each slot, m^3
  PALPATE_ADDRESS(Floats) forces;   // out: planes, N
  PALPATE_ADDRESS(SoftSkinCells) skinCells;
  PALPATE_ADDRESS(Vec4s) skin;
  PALPATE_ADDRESS(ToolStates) tools;
  PALPATE_ADDRESS(Vec4s) sums;       // out: rows of blocks of slots
  PALPATE_ADDRESS(CellRests) rests;  // of each slot; without a volume: a cube; nothing where all are
  PALPATE_ADDRESS(Vec4s) present;    // the nodes as they are, for a trial
  uint skinCount;                    // cells with places of the skin
  uint firstInner;                   // slot of the first one without
  uint slots;
  uint stride;
  uint blocks;
  uint toolCount;
  uint begins;  // whether the substep is the first one of its step
  uint ends;    // the last one
};
PALPATE_SIZE(SoftCellsArgs, 120);

// Where the nodes go; one workgroup more, the first one, has what that did to the tools, and where they go next.
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
  uint skinBlocks;  // of those of cells
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

// Change of displacements over each cell, by what it holds.
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

// The mean of those of the cells about each node.
struct SoftBlendArgs {
  PALPATE_ADDRESS(UVec4s) incident;
  PALPATE_ADDRESS(Floats) volumes;
  PALPATE_ADDRESS(Floats) gradients;
  PALPATE_ADDRESS(Vec4s) nodeGradients;  // out
  uint nodeCount;
  uint stride;
};
PALPATE_SIZE(SoftBlendArgs, 40);

// Where the points are that the body carries.
struct SoftCarryArgs {
  PALPATE_ADDRESS(SoftSettings) setting;
  PALPATE_ADDRESS(Vec4s) nodes;
  PALPATE_ADDRESS(Vec4s) nodeGradients;
  PALPATE_ADDRESS(UVec4s) corners;
  PALPATE_ADDRESS(Vec4s) rests;         // where each rests, m; bits of the slot of its cell
  PALPATE_ADDRESS(Vec4s) shares;        // of the cell along each axis; x of the normal at rest
  PALPATE_ADDRESS(UVec2s) normalRests;  // bits of y and z
  PALPATE_ADDRESS(Vec4s) positions;     // out, as what follows, as a live cloud has them; bits of the id
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Vec4s) velocities;  // by id
  uint points;
  float unitsPerMetre;  // of what is written
  vec3 origin;          // of it, in those units
  uint unused;
};
PALPATE_SIZE(SoftCarryArgs, 104);

PALPATE_SHARED_END

#endif
