// What the passes of a fusion on the GPU read and write (engine/motion/fusion_pass.hpp): a frame into a live cloud.
#ifndef PALPATE_SHARED_FUSION_PASSES_H
#define PALPATE_SHARED_FUSION_PASSES_H
#include "shaders/shared/fusion.h"
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// Bits of a word of the masks below.
const uint kMaskBits = 32u;
// Maximum for a workgroup of any size.
const uint kMaxMaskWords = 32u;

// The bits next to a point's normal in the live cloud: its colour, red in the lowest byte and 0 in the highest; grey if
// its colour was never seen.
PALPATE_FUNCTION uint colorBeside(SurfelRecord record) {
  return (record.color >> 24 != 0u ? record.color : kUnseenColor) & 0xffffffu;
}

// Counts of the points in a frame.
struct FusionTotals {
  uint points;  // before new ones are appended
  uint matched;
  uint appended;
  uint removed;
  uint refused;
};
PALPATE_SIZE(FusionTotals, 20);

PALPATE_SHARED_END

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer FusionViews { FusionView at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Depths { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PixelSurfaces { PixelSurface at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SurfelRecords { SurfelRecord at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer FusionTotalsAt { FusionTotals now; };
#endif

PALPATE_SHARED_BEGIN

// The images of a frame, row by row.
struct PixelSurfaceArgs {
  PALPATE_ADDRESS(FusionViews) view;
  PALPATE_ADDRESS(Depths) depths;
  PALPATE_ADDRESS(PixelSurfaces) surfaces;  // out
  PALPATE_ADDRESS(Uints) covered;           // out: 0 for each pixel
  uint pixels;
  uint unused;
};
PALPATE_SIZE(PixelSurfaceArgs, 40);

struct FusePointsArgs {
  PALPATE_ADDRESS(FusionViews) view;
  PALPATE_ADDRESS(Depths) depths;
  PALPATE_ADDRESS(Uints) colors;
  PALPATE_ADDRESS(PixelSurfaces) surfaces;
  PALPATE_ADDRESS(Uints) covered;      // by pixel: the parts that contain points
  PALPATE_ADDRESS(Vec4s) positionsIn;  // by slot
  PALPATE_ADDRESS(Vec4s) normalsIn;
  PALPATE_ADDRESS(Vec4s) positionsOut;
  PALPATE_ADDRESS(Vec4s) normalsOut;
  PALPATE_ADDRESS(SurfelRecords) records;  // by id
  PALPATE_ADDRESS(Uints) freeIds;          // a bit for each id that a new point may have
  PALPATE_ADDRESS(Uints) emptySlots;       // out: a bit for each slot without a point
  PALPATE_ADDRESS(FusionTotalsAt) totals;
  PALPATE_ADDRESS(Vec4s) velocitiesIn;  // as in shaders/shared/motion.h, with rates of the normals; if the map is felt
  PALPATE_ADDRESS(Vec4s) velocitiesOut;
  uint slots;
  uint unused;
};
PALPATE_SIZE(FusePointsArgs, 128);

struct FindNewArgs {
  PALPATE_ADDRESS(FusionViews) view;
  PALPATE_ADDRESS(PixelSurfaces) surfaces;
  PALPATE_ADDRESS(Uints) covered;
  PALPATE_ADDRESS(Uints) newPixels;  // out: a bit for each pixel that needs a new point
  PALPATE_ADDRESS(Uints) counts;     // out: set bits in each word of newPixels
  PALPATE_ADDRESS(UVec2s) places;    // out: kEmptySlot for each pixel
  uint pixels;
  uint unused;
};
PALPATE_SIZE(FindNewArgs, 56);

// Set bits in each word of two masks of the same length.
struct CountFreeArgs {
  PALPATE_ADDRESS(Uints) freeIds;
  PALPATE_ADDRESS(Uints) emptySlots;
  PALPATE_ADDRESS(Uints) idCounts;    // out
  PALPATE_ADDRESS(Uints) slotCounts;  // out
  uint words;
  uint unused;
};
PALPATE_SIZE(CountFreeArgs, 40);

// The counts are exclusive prefix sums by now.
struct ListFreeArgs {
  PALPATE_ADDRESS(Uints) freeIds;  // in and out: assigned ids are cleared
  PALPATE_ADDRESS(Uints) emptySlots;
  PALPATE_ADDRESS(Uints) idsBefore;
  PALPATE_ADDRESS(Uints) slotsBefore;
  PALPATE_ADDRESS(UVec2s) places;  // out: id and slot of each new point that finds room
  PALPATE_ADDRESS(Uints) newPixels;
  PALPATE_ADDRESS(Uints) newBefore;
  PALPATE_ADDRESS(FusionTotalsAt) totals;
  uint words;
  uint pixelWords;
  uint slots;
  uint unused;
};
PALPATE_SIZE(ListFreeArgs, 80);

struct AppendPointsArgs {
  PALPATE_ADDRESS(FusionViews) view;
  PALPATE_ADDRESS(Depths) depths;
  PALPATE_ADDRESS(Uints) colors;
  PALPATE_ADDRESS(PixelSurfaces) surfaces;
  PALPATE_ADDRESS(Uints) newPixels;
  PALPATE_ADDRESS(Uints) newBefore;
  PALPATE_ADDRESS(UVec2s) places;
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(SurfelRecords) records;
  PALPATE_ADDRESS(FusionTotalsAt) totals;
  PALPATE_ADDRESS(Vec4s) velocities;  // if the map is felt
  uint pixels;
  uint slots;
};
PALPATE_SIZE(AppendPointsArgs, 104);

PALPATE_SHARED_END
#endif
