// Passes that add to the plain light of a picture: occlusion, cavities, eye-dome light and the shadow on the ground.
#ifndef PALPATE_SHARED_LOOK_H
#define PALPATE_SHARED_LOOK_H
#include "shaders/shared/render.h"

PALPATE_SHARED_BEGIN

// Directions in which a pixel looks for the horizon, to both sides, and samples on each side. A pattern of 4 x 4 pixels
// rotates the directions, and the blur over as many pixels removes the pattern.
const uint kSlices = 2;
const uint kSliceSteps = 8;
// Within which surfaces hide the sky, in RenderFrame::occlusionRadius.
const float kSkyRadius = 4;
// Longest distance of those samples, of the picture's height.
const float kHorizonReach = 0.25f;
// Exponent of the share of the sky in the light: reflections between surfaces aside, 1 would be right for a white sky.
const float kOcclusionPower = 2;
// In usual radii: height above the surface from which a sample looks, so that discs do not hide each other.
const float kHorizonLift = 0.25f;
// In usual radii, and in pixels: distance from a pixel's plane over which occlusion is blurred.
const float kBlurRadii = 1;
const float kBlurPixels = 2;

// Curvature is measured over two rings of eight pixels: a narrow one whose radius follows the discs', and a wide one.
const float kCavityRadii = 0.75f;  // of the narrow ring, usual radii
const uint kCavityWidest_px = 8;   // of the narrow ring
const uint kCavityScale = 4;       // radius of the wide ring in those of the narrow one
// Change of the normal over a ring's radius, radians, at which half of the effect is reached.
const float kCavityHalf = 0.2f;
const float kValleyShade = 0.6f;  // largest share by which valleys darken
const float kRidgeLight = 0.35f;  // and ridges brighten

// Rings of eight samples around each sample: their number, the radius of the widest one in pixels of the picture, and
// how fast depth darkens.
const uint kEyeDomeRings = 2;
const float kEyeDomeWidest_px = 3;
const float kEyeDomeStrength = 0.3f;
const float kEyeDomeSteepest = 6;  // larger slopes count as this one

// Directions in which a cell of the ground looks for the columns that hide its sky; a pattern rotates them as above.
const uint kGroundDirections = 16;
const float kGroundUnit = 65536;  // fixed-point unit of their sum
const uint kMaxGroundCells = 96;  // along each side of the map
const float kGroundStrength = 0.8f;
const float kGroundFade = 0.25f;  // share of the map's side, at its borders, over which the shadow fades out

struct SurfelArgs {
  PALPATE_ADDRESS(Uints) source;  // as in ShadeArgs, like the next two
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(Uints) normalSums;
  PALPATE_ADDRESS(UVec2s)
  surfels;  // out, one per pixel: bits of the depth, and the normal (shaders/render/surfel.glsl)
};
PALPATE_SIZE(SurfelArgs, 32);

struct OcclusionArgs {
  PALPATE_ADDRESS(UVec2s) surfels;
  PALPATE_ADDRESS(Floats) from;  // of the blur: one per pixel
  PALPATE_ADDRESS(Floats) to;    // out: share of the sky that reaches the surface
};
PALPATE_SIZE(OcclusionArgs, 24);

struct CavityArgs {
  PALPATE_ADDRESS(UVec2s) surfels;
  PALPATE_ADDRESS(Floats) cavity;  // out, one per pixel: factor on the light
};
PALPATE_SIZE(CavityArgs, 16);

struct EyeDomeArgs {
  PALPATE_ADDRESS(Uints) source;
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(UVec2s) shaded;  // in and out
};
PALPATE_SIZE(EyeDomeArgs, 24);

// A square map of the ground. Heights are above it, model units.
struct GroundMap {
  vec3 corner;  // of its first cell
  float cell;   // side of a cell
  vec3 up;      // unit, along an axis, like the next two
  uint cells;   // along each side
  vec3 along;   // from cell to cell in a row
  uint count;   // points, or corners of triangles
  vec3 across;  // from row to row
  uint unused;
};
PALPATE_SIZE(GroundMap, 64);

struct GroundHeightsArgs {
  GroundMap map;
  PALPATE_ADDRESS(Vec4s) positions;  // of points; null: the corners of triangles
  PALPATE_ADDRESS(Uints) hidden;     // a bit for each point; null: none is hidden
  PALPATE_ADDRESS(MeshVertices) vertices;
  PALPATE_ADDRESS(Uints) triangles;
  PALPATE_ADDRESS(Uints) heights;  // bits of the lowest height above each cell, kNoDepth: none; then of the highest
};
PALPATE_SIZE(GroundHeightsArgs, 104);

struct GroundShadowArgs {
  GroundMap map;
  PALPATE_ADDRESS(Uints) heights;
  PALPATE_ADDRESS(Uints) rough;    // one per cell: sky that is hidden, of all directions, with the pattern; kGroundUnit
  PALPATE_ADDRESS(Floats) shadow;  // out, one per cell: share of the sky that is hidden, without the pattern
};
PALPATE_SIZE(GroundShadowArgs, 88);

struct GroundArgs {
  GroundMap map;
  PALPATE_ADDRESS(Uints) source;
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(UVec2s) shaded;  // in and out
  PALPATE_ADDRESS(Floats) shadow;
};
PALPATE_SIZE(GroundArgs, 96);

PALPATE_SHARED_END
#endif
