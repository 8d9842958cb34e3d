// State of a simulation of matter on a GPU, in memory (engine/matter/matter_passes.hpp). Particles are in slots, in the
// order of their cells; all arrays by slot except the lists have one entry for each.
#ifndef PALPATE_SHARED_MATTER_STATE_H
#define PALPATE_SHARED_MATTER_STATE_H
#include "shaders/shared/matter.h"
#include "shaders/shared/matter_bodies.h"
#include "shaders/shared/matter_cells.h"
#include "shaders/shared/matter_model.h"

PALPATE_SHARED_BEGIN

// Slots of a block: a workgroup, whose sums have a fixed order.
const uint kMatterBlock = 256u;
// Neighbours that are adjacent in a list, so that one load reads them: the first four of a slot and its next four are
// `stride` times as many words apart.
const uint kListedAtOnce = 4u;
// Bits of a neighbour's slot; the bits above hold the image that is near.
const uint kSlotBits = 27u;
// Maximum particles of a cell that can be sorted. A cell is at most as wide as the reach of lists: with more particles
// one of its octants holds more than the longest list, and is crowded in any case.
const uint kMaxInCell = 1040u;
// Factor on the predicted displacement of particles, if lists have to stay valid for some substeps: velocities change
// meanwhile.
const float kForesight = 1.25f;
// Maximum cells that an invocation clears.
const uint kEmptiedAtOnce = 4u;

// Values of MatterState.
const uint kMatterRunning = 0u;
const uint kMatterDiverged = 1u;
const uint kMatterCrowded = 2u;

// From this value on the bits of a non-negative float are not those of a finite number.
const uint kNotFinite = 0x7f800000u;

// State of the simulation; initially zero.
struct MatterControl {
  uint state;
  uint parity;    // half of velocities and contacts that is read in this substep, while the other one is written
  uint late;      // substeps in which lists should have been made but could not
  uint lists;     // number of times they were made
  uint farthest;  // bits of the square of the maximum displacement that a particle will have since they were made, m^2
  uint crowdedCell;  // whether a cell holds more particles than can be sorted
  uint crowdedList;  // whether a list is full
  uint substeps;     // of this step that have run
};
PALPATE_SIZE(MatterControl, 32);

// Sums over all particles after a substep; for the walls and the model, impulses since the step began.
struct MatterSums {
  vec3 onWalls;  // kg m/s
  float kinetic;
  vec3 momentum;
  float mostCompression;
  vec3 onModel;      // kg m/s
  vec3 turnOfModel;  // about the middle of its volume, kg m^2/s
  uint unused;       // validation counts a write to a vec3 as 16 bytes, which have to exist
};
PALPATE_SIZE(MatterSums, 60);

// Constants of all substeps, in memory.
struct MatterSetting {
  MatterCells cells;      // of the particles
  MatterCells bodyCells;  // of the points of a tool's ball
  WaterRules water;
  GrainRules grains;
  ToolSpring spring;
  ModelField model;
  vec3 modelMiddle;   // of its volume, m
  vec3 bodyMiddle;    // of the ball in the box of its cells, m
  float bodyReach;    // of its points and their support from bodyMiddle, m
  vec3 fall;          // velocity change by gravity in a substep, m/s
  float bodySupport;  // m
  float ballRadius;   // m
  float bodyKept;     // radius around its middle in which the ball holds no particles, m
  float bodyPush;     // maximum outward displacement of particles within it in a substep, m
  float listed;       // reach of lists, m
  float allowed;      // displacement of a particle after which lists are made again, m
  float nearest;      // minimum distance of a particle from a wall, m
  float step;         // s
  float mass;         // of a particle, kg
  float mostKinetic;  // J
  uint bodyPoints;
  uint mostListed;  // maximum in a list, a multiple of kListedAtOnce
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
  float grown;  // of the ball, m; validation counts a read of a vec3 as 16 bytes, which have to exist
};
PALPATE_SIZE(HandStep, 76);

// The ball of a tool. Its offset from the hand keeps digits that its position has lost.
struct ToolState {
  vec3 lag;  // from the hand, m
  vec3 place;
  vec3 velocity;
  vec3 spin;
  vec3 x;
  vec3 y;
  vec3 z;
  float grown;         // m
  vec3 springImpulse;  // since the step began, like the following: kg m/s
  vec3 impulse;        // by the matter
  vec3 angular;        // by the matter, about its middle, kg m^2/s
  vec3 modelImpulse;   // by the model at rest in the matter
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
