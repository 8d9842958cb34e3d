// What the passes of matter on the GPU read and write (engine/matter/matter_passes.hpp). Particles stand in slots, in the
// order of their cells; all that is by slot but the lists has one entry for each.
#ifndef PALPATE_SHARED_MATTER_PASSES_H
#define PALPATE_SHARED_MATTER_PASSES_H
#include "shaders/shared/matter.h"
#include "shaders/shared/matter_bodies.h"
#include "shaders/shared/matter_cells.h"

PALPATE_SHARED_BEGIN

// Slots of a block: a workgroup, whose sums have one order.
const uint kMatterBlock = 256u;
// Neighbours that stand side by side in a list, so that one load brings them: `stride` times so many words lie between
// the first four of a slot and the next four.
const uint kListedAtOnce = 4u;
// Bits of a neighbour's slot; the image of it that is near stands above them.
const uint kSlotBits = 27u;
// Particles of a cell that can be put in order. A cell is no wider than lists reach, so that an eighth of it with more than
// the longest list in it is crowded for sure.
const uint kMostInCell = 1040u;
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
  uint listed;       // whether there are lists
  uint lists;        // how often they were made
  uint farthest;     // bits of the square of what a particle has gone at most since they were made, m^2
  uint crowdedCell;  // whether one holds more than can be put in order
  uint crowdedList;  // whether one has no room
  uint substeps;     // of this step that were run
};
PALPATE_SIZE(MatterControl, 32);

// All particles together, after a substep; what the walls got since the step began.
struct MatterSums {
  vec3 onWalls;  // kg m/s
  float kinetic;
  vec3 momentum;
  float mostCompression;
};
PALPATE_SIZE(MatterSums, 32);

// What is the same in all substeps, in memory.
struct MatterSetting {
  MatterCells cells;      // of the particles
  MatterCells bodyCells;  // of the points of a tool's ball
  WaterRules water;
  GrainRules grains;
  ToolSpring spring;
  vec3 bodyMiddle;    // of the ball in the box of its cells, m
  float bodyReach;    // of its points and their support from there, m
  vec3 fall;          // what gravity adds to a velocity in a substep, m/s
  float bodySupport;  // m
  float listed;       // so far lists reach, m
  float allowed;      // so far a particle may go until they are made again, m
  float nearest;      // to a wall that a particle may come, m
  float step;         // s
  float mass;         // of a particle, kg
  float mostKinetic;  // J
  uint bodyPoints;
  uint mostListed;  // in a list, a multiple of kListedAtOnce
};
PALPATE_SIZE(MatterSetting, 216);

// A hand at the end of a substep.
struct HandStep {
  vec3 place;
  vec3 move;  // since the substep began, m
  vec3 spin;
  vec3 x;  // its axes in the world
  vec3 y;
  vec3 z;
  uint unused;  // validation takes what it says of a vec3 for 16 bytes, which have to be there
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
  vec3 springImpulse;  // since the step began, as what follows: kg m/s
  vec3 impulse;        // of the matter
  vec3 angular;        // of the matter, about its middle, kg m^2/s
  float portWork;      // of the hand, J
};
PALPATE_SIZE(ToolState, 124);

PALPATE_SHARED_END

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer UVec4s { uvec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MatterControls { MatterControl now; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MatterSettings { MatterSetting now; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MatterSumsAt { MatterSums now; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer HandSteps { HandStep at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ToolStates { ToolState at[]; };
#endif

PALPATE_SHARED_BEGIN

// Where particles and tools go by themselves, and how far the farthest one has come; empties the counts of cells.
struct MatterPredictArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) velocities;  // two halves
  PALPATE_ADDRESS(Vec4s) listedAt;    // places when the lists were made
  PALPATE_ADDRESS(Vec4s) places;      // out
  PALPATE_ADDRESS(Uints) firsts;      // out: `counts` zeros
  PALPATE_ADDRESS(HandSteps) hands;   // substep by substep
  PALPATE_ADDRESS(ToolStates) tools;
  uint particles;
  uint counts;
  uint threads;
  uint toolCount;
  uint substep;  // in its step
  uint unused;
};
PALPATE_SIZE(MatterPredictArgs, 96);

// The cell of each particle, and its place among those of the cell in the order of their arrival.
struct MatterCountArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Vec4s) places;
  PALPATE_ADDRESS(Uints) firsts;  // in and out: particles of each cell
  PALPATE_ADDRESS(Uints) cells;   // out: of each particle
  PALPATE_ADDRESS(Uints) arrivals;
  uint particles;
  uint unused;
};
PALPATE_SIZE(MatterCountArgs, 56);

// Counts to where each cell begins: reduce, then scan (engine/spatial/prefix_scan.hpp).
struct MatterScanArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Uints) firsts;
  PALPATE_ADDRESS(Uints) tileSums;
  uint counts;
  uint tiles;
};
PALPATE_SIZE(MatterScanArgs, 40);

struct MatterPlaceArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Uints) firsts;
  PALPATE_ADDRESS(Uints) cells;
  PALPATE_ADDRESS(Uints) arrivals;
  PALPATE_ADDRESS(Uints) order;  // out: slots by cells, and by arrival within them
  uint particles;
  uint unused;
};
PALPATE_SIZE(MatterPlaceArgs, 56);

// Particles in the order of their cells, and within a cell as they stood.
struct MatterSortArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Uints) firsts;
  PALPATE_ADDRESS(Uints) cells;
  PALPATE_ADDRESS(Uints) order;
  PALPATE_ADDRESS(Vec4s) places;
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) velocities;
  PALPATE_ADDRESS(Uints) ids;
  PALPATE_ADDRESS(Vec4s) sortedPlaces;  // out, as all that follow
  PALPATE_ADDRESS(Vec4s) sortedPositions;
  PALPATE_ADDRESS(Vec4s) sortedVelocities;
  PALPATE_ADDRESS(Uints) sortedIds;
  uint particles;
  uint unused;
};
PALPATE_SIZE(MatterSortArgs, 112);

// Lists of neighbours; what was sorted goes back to where it is used.
struct MatterListArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Uints) firsts;
  PALPATE_ADDRESS(Vec4s) sortedPlaces;
  PALPATE_ADDRESS(Vec4s) sortedPositions;
  PALPATE_ADDRESS(Vec4s) sortedVelocities;
  PALPATE_ADDRESS(Uints) sortedIds;
  PALPATE_ADDRESS(Vec4s) places;  // out, as all that follow
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) velocities;
  PALPATE_ADDRESS(Uints) ids;
  PALPATE_ADDRESS(UVec4s) lists;
  PALPATE_ADDRESS(Uints) listLengths;
  uint particles;
  uint stride;
};
PALPATE_SIZE(MatterListArgs, 112);

struct MatterCompressArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Vec4s) places;
  PALPATE_ADDRESS(UVec4s) lists;
  PALPATE_ADDRESS(Uints) listLengths;
  PALPATE_ADDRESS(Vec4s) pressed;  // out: places; w: compression
  PALPATE_ADDRESS(ToolStates) tools;
  PALPATE_ADDRESS(Vec4s) bodyPoints;  // in the order of their cells: place in their box; w: volume
  PALPATE_ADDRESS(Uints) bodyFirsts;
  uint particles;
  uint stride;
  uint toolCount;
  uint unused;
};
PALPATE_SIZE(MatterCompressArgs, 88);

struct MatterPushArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Vec4s) pressed;
  PALPATE_ADDRESS(Vec4s) positions;   // out
  PALPATE_ADDRESS(Vec4s) velocities;  // one half in, the other one out
  PALPATE_ADDRESS(UVec4s) lists;
  PALPATE_ADDRESS(Uints) listLengths;
  PALPATE_ADDRESS(Vec4s) sums;  // out: a row of blocks for each (blockSums of shaders/lib/matter_sums.glsl)
  PALPATE_ADDRESS(ToolStates) tools;
  PALPATE_ADDRESS(Vec4s) bodyPoints;
  PALPATE_ADDRESS(Uints) bodyFirsts;
  uint particles;
  uint stride;
  uint toolCount;
  uint blocks;
};
PALPATE_SIZE(MatterPushArgs, 104);

// The same for grains.
struct MatterRubArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Vec4s) places;
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) velocities;
  PALPATE_ADDRESS(Uints) ids;
  PALPATE_ADDRESS(UVec4s) lists;
  PALPATE_ADDRESS(Uints) listLengths;
  PALPATE_ADDRESS(UVec4s) contacts;       // by id, two halves: bits of the slip, and with whom
  PALPATE_ADDRESS(Uints) contactCounts;  // by id, two halves
  PALPATE_ADDRESS(Vec4s) sums;
  PALPATE_ADDRESS(ToolStates) tools;
  PALPATE_ADDRESS(Vec4s) bodyPoints;
  PALPATE_ADDRESS(Uints) bodyFirsts;
  uint particles;
  uint stride;
  uint toolCount;
  uint blocks;
};
PALPATE_SIZE(MatterRubArgs, 128);

// The end of a substep: sums of all blocks, what they do to the tools, and how the simulation is.
struct MatterFinishArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Vec4s) sums;
  PALPATE_ADDRESS(MatterSumsAt) total;
  PALPATE_ADDRESS(ToolStates) tools;
  uint blocks;
  uint toolCount;
  uint substep;
  uint unused;
};
PALPATE_SIZE(MatterFinishArgs, 56);

PALPATE_SHARED_END
#endif
