// What a simulation of matter on a GPU knows of itself, in memory there (engine/matter/matter_memory.hpp). Particles
// stand in slots, in the order of their cells; all that is by slot but the lists has one entry for each.
#ifndef PALPATE_SHARED_MATTER_STATE_H
#define PALPATE_SHARED_MATTER_STATE_H
#include "shaders/shared/matter.h"
#include "shaders/shared/matter_bodies.h"
#include "shaders/shared/matter_cells.h"
#include "shaders/shared/matter_model.h"

PALPATE_SHARED_BEGIN

// Slots of a block: a workgroup, whose sums have one order.
const uint kMatterBlock = 256u;
// Neighbours that stand side by side in a list, so that one load brings them: `stride` times so many words lie between
// the first four of a slot and the next four.
const uint kListedAtOnce = 4u;
// Bits of a neighbour's slot; the image of it that is near stands above them.
const uint kSlotBits = 27u;
// Particles of a cell that can be put in order. A cell is no wider than lists reach, so that an eighth of it with more
// than the longest list in it is crowded for sure.
const uint kMaxInCell = 1040u;
// Lists that are to be good for some substeps are made as if particles went so much farther in them than they will at
// their present velocities: these change.
const float kForesight = 1.25f;
// Cells that an invocation empties at the most.
const uint kEmptiedAtOnce = 4u;

// As MatterState has them.
const uint kMatterRunning = 0u;
const uint kMatterDiverged = 1u;
const uint kMatterCrowded = 2u;

// From this on the bits of a float that is not below 0 are those of no finite number.
const uint kNotFinite = 0x7f800000u;

// How the simulation is; all zero in the beginning.
struct MatterControl {
  uint state;
  uint parity;       // half of velocities and contacts that is read in this substep, while the other one is written
  uint late;         // substeps in which lists could not be made and should have been
  uint lists;        // how often they were made
  uint farthest;     // bits of the square of what a particle will have gone at most since they were made, m^2
  uint crowdedCell;  // whether one holds more than can be put in order
  uint crowdedList;  // whether one has no room
  uint substeps;     // of this step that were run
};
PALPATE_SIZE(MatterControl, 32);

// All particles together, after a substep; what the walls and the model got since the step began.
struct MatterSums {
  vec3 onWalls;  // kg m/s
  float kinetic;
  vec3 momentum;
  float mostCompression;
  vec3 onModel;      // kg m/s
  vec3 turnOfModel;  // about the middle of its volume, kg m^2/s
  uint unused;       // validation takes what is written to a vec3 for 16 bytes, which have to be there
};
PALPATE_SIZE(MatterSums, 60);

// What is the same in all substeps, in memory.
struct MatterSetting {
  MatterCells cells;      // of the particles
  MatterCells bodyCells;  // of the points of a tool's ball
  WaterRules water;
  GrainRules grains;
  ToolSpring spring;
  ModelField model;
  vec3 modelMiddle;   // of its volume, m
  vec3 bodyMiddle;    // of the ball in the box of its cells, m
  float bodyReach;    // of its points and their support from there, m
  vec3 fall;          // what gravity adds to a velocity in a substep, m/s
  float bodySupport;  // m
  float ballRadius;   // m
  float bodyKept;     // so far from its middle nothing is within the ball, m
  float bodyPush;     // what is goes outwards so far in a substep at most, m
  float listed;       // so far lists reach, m
  float allowed;      // so far a particle may go until they are made again, m
  float nearest;      // to a wall that a particle may come, m
  float step;         // s
  float mass;         // of a particle, kg
  float mostKinetic;  // J
  uint bodyPoints;
  uint mostListed;  // in a list, a multiple of kListedAtOnce
};
PALPATE_SIZE(MatterSetting, 276);

// A hand at the end of a substep.
struct HandStep {
  vec3 place;
  vec3 move;  // since the substep began, m
  vec3 spin;
  vec3 x;  // its axes in the world
  vec3 y;
  vec3 z;
  float grown;  // of the ball, m; validation takes what it says of a vec3 for 16 bytes, which have to be there
};
PALPATE_SIZE(HandStep, 76);

// The ball of a tool. Where it is from the hand keeps digits that its place has not.
struct ToolState {
  vec3 lag;  // from the hand, m
  vec3 place;
  vec3 velocity;
  vec3 spin;
  vec3 x;
  vec3 y;
  vec3 z;
  float grown;         // m
  vec3 springImpulse;  // since the step began, as what follows: kg m/s
  vec3 impulse;        // of the matter
  vec3 angular;        // of the matter, about its middle, kg m^2/s
  vec3 modelImpulse;   // of the model that stands in the matter
  float portWork;      // of the hand, J
};
PALPATE_SIZE(ToolState, 140);

PALPATE_SHARED_END

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer UVec4s { uvec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MatterControls { MatterControl now; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MatterSettings { MatterSetting now; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MatterSumsAt { MatterSums now; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer HandSteps { HandStep at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ToolStates { ToolState at[]; };
#endif

#endif
