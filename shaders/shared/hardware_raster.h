// Discs drawn by the graphics pipeline (engine/render/hardware_raster.hpp).
#ifndef PALPATE_SHARED_HARDWARE_RASTER_H
#define PALPATE_SHARED_HARDWARE_RASTER_H
#include "shaders/shared/render.h"

PALPATE_SHARED_BEGIN

// Fragment shaders read only these arguments and the outputs of the vertex shader: they are invoked often, and the
// validation layer of Debian 12 would report their reads through addresses as wrong on a software driver, where lanes
// outside a disc read nothing and never end its search for the buffer.

// Units of weight in each covered sample.
const float kHardwareWeight = 1 << 20;

struct HardwareDiscArgs {
  PALPATE_ADDRESS(Vec4s) positions;  // as in SplatArgs, like the next three
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;
  PALPATE_ADDRESS(Uints) clips;
  vec2 center_px;  // of the view, like the next two
  float focal_px;
  float nearDepth;
  float depthScale;  // factor from a depth to the value in the depth attachment; a power of two, so that no bit is lost
  float lead;        // in radii: fragments are tested as if they were nearer by this
  float leastWeight;  // minimum for a fragment, so that samples covered only by light ones are not lost in fixed point
  uint count;         // of the points; vertices are rounded up
  uint largestPoint_px;  // maximum side of a point sprite
  uint tiles;            // of that size, along each side of a disc's box; one vertex for each
};
PALPATE_SIZE(HardwareDiscArgs, 72);

struct HardwareSumsArgs {
  PALPATE_ADDRESS(Uints) depth;  // as in SplatArgs, like the sums
  PALPATE_ADDRESS(Uints) normalSums;
  PALPATE_ADDRESS(Uints) colorSums;
  float depthUnit;  // 1 / depthScale
  uint unused;
};
PALPATE_SIZE(HardwareSumsArgs, 32);

PALPATE_SHARED_END
#endif
