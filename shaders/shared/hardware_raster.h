// Discs drawn by the graphics pipeline (engine/render/hardware_raster.hpp).
#ifndef PALPATE_SHARED_HARDWARE_RASTER_H
#define PALPATE_SHARED_HARDWARE_RASTER_H
#include "shaders/shared/render.h"

PALPATE_SHARED_BEGIN

// Fragment shaders read nothing but these arguments and what the vertex shader tells them: they are invoked often, and
// the validation layer of Debian 12 would take their reads through addresses for wrong on a software driver, where
// lanes outside a disc read nothing and never end its search for the buffer.
// Units of weight in each sample that something covers.
const float kHardwareWeight = 1 << 20;

struct HardwareDiscArgs {
  PALPATE_ADDRESS(RenderFrames) frame;
  PALPATE_ADDRESS(Vec4s) positions;  // as in SplatArgs, and so on
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;
  PALPATE_ADDRESS(Uints) clips;
  vec2 center_px;  // of the view, and so on
  float focal_px;
  float nearDepth;
  float depthScale;      // times a depth: what the depth attachment holds; a power of two, so that no bit is lost
  float lead;            // in radii: fragments are tested as if they were so much nearer
  float leastWeight;     // of a fragment: what only thin ones cover must not be lost in the sums' fixed point
  uint count;            // of the points; vertices are rounded up
  uint largestPoint_px;  // side of a point sprite at most
  uint tiles;            // of that size, along each side of a disc's box; a vertex for each
};
PALPATE_SIZE(HardwareDiscArgs, 80);

struct HardwareSumsArgs {
  PALPATE_ADDRESS(RenderFrames) frame;
  PALPATE_ADDRESS(Uints) depth;  // as in SplatArgs, and so the sums
  PALPATE_ADDRESS(Uints) normalSums;
  PALPATE_ADDRESS(Uints) colorSums;
  float depthUnit;  // 1 / depthScale
  uint unused;
};
PALPATE_SIZE(HardwareSumsArgs, 40);

PALPATE_SHARED_END
#endif
