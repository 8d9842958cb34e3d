// What the passes of matter on a GPU read and write (engine/matter/matter_passes.hpp).
#ifndef PALPATE_SHARED_MATTER_PASSES_H
#define PALPATE_SHARED_MATTER_PASSES_H
#include "shaders/shared/matter_state.h"

PALPATE_SHARED_BEGIN

// Predicts particles and tools, and how far the farthest particle has moved; clears the counts of cells.
struct MatterPredictArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) velocities;  // two halves
  PALPATE_ADDRESS(Vec4s) listedAt;    // positions when the lists were made
  PALPATE_ADDRESS(Vec4s) places;      // out
  PALPATE_ADDRESS(Uints) firsts;      // out: `counts` zeros
  PALPATE_ADDRESS(HandSteps) hands;   // substep by substep
  PALPATE_ADDRESS(ToolStates) tools;
  PALPATE_ADDRESS(Vec4s) bodyPoints;  // of a ball; the nodes of the model follow them
  uint particles;
  uint counts;
  uint threads;
  uint toolCount;
  uint substep;  // in its step
  uint ahead;    // substeps after this one for which lists have to stay valid
};
PALPATE_SIZE(MatterPredictArgs, 104);

// The cell of each particle, and its rank in that cell in the order of arrival.
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

// Turns counts into the first index of each cell: reduce, then scan (engine/spatial/prefix_scan.hpp).
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

// Sorts particles by cell, and within a cell by their previous order.
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
  PALPATE_ADDRESS(Vec4s) sortedPlaces;  // out, like all that follow
  PALPATE_ADDRESS(Vec4s) sortedPositions;
  PALPATE_ADDRESS(Vec4s) sortedVelocities;
  PALPATE_ADDRESS(Uints) sortedIds;
  uint particles;
  uint unused;
};
PALPATE_SIZE(MatterSortArgs, 112);

// Makes the neighbour lists; copies the sorted arrays back to the ones in use.
struct MatterListArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Uints) firsts;
  PALPATE_ADDRESS(Vec4s) sortedPlaces;
  PALPATE_ADDRESS(Vec4s) sortedPositions;
  PALPATE_ADDRESS(Vec4s) sortedVelocities;
  PALPATE_ADDRESS(Uints) sortedIds;
  PALPATE_ADDRESS(Vec4s) places;  // out, like all that follow
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
  PALPATE_ADDRESS(Vec4s) pressed;  // out: positions; w: compression
  PALPATE_ADDRESS(ToolStates) tools;
  PALPATE_ADDRESS(Vec4s) bodyPoints;  // in the order of their cells: position in their box; w: volume
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
  PALPATE_ADDRESS(Vec4s) sums;  // out: a row of blocks for each (addUp() of shaders/lib/matter_sums.glsl)
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
  PALPATE_ADDRESS(UVec4s) contacts;      // by id, two halves: bits of the slip, and the partner
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

// The end of a substep: the sums of all blocks, their effect on the tools, and the state of the simulation.
struct MatterFinishArgs {
  PALPATE_ADDRESS(MatterControls) control;
  PALPATE_ADDRESS(MatterSettings) setting;
  PALPATE_ADDRESS(Vec4s) sums;
  PALPATE_ADDRESS(MatterSumsAt) total;
  PALPATE_ADDRESS(ToolStates) tools;
  uint blocks;
  uint toolCount;
  uint substep;
  uint makesLists;  // whether lists could be made in this substep
};
PALPATE_SIZE(MatterFinishArgs, 56);

PALPATE_SHARED_END
#endif
