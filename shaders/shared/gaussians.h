// The Gaussians of a splat scene in a picture (engine/render/gaussian_pass.hpp).
#ifndef PALPATE_SHARED_GAUSSIANS_H
#define PALPATE_SHARED_GAUSSIANS_H
#include "shaders/shared/render.h"
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// Side of the tile of pixels that one workgroup composites: a software driver takes longer for a workgroup, and to load
// a Gaussian, than for its pixels.
const uint kGaussianTile = 16;
const uint kGaussianTileOfSoftware = 32;
const uint kGaussianBlocks = 8;  // along a side of the tile, one for each invocation
const uint kGaussianWorkgroup = kGaussianBlocks * kGaussianBlocks;
// Words of a bin's list that an invocation reads at a time, and Gaussians that a workgroup then lists at a time: more
// need fewer barriers, and more shared memory.
const uint kGaussianWords = 8;
const uint kGaussianListed = 1024;
// Smallest side of the bins of pixels that list their Gaussians, and the memory of all lists. Where the lists would be
// longer the bins are larger.
const uint kGaussianBin = 32;  // a multiple of the tiles
const uint kGaussianBinBytes = 1u << 25;
// What is added to the variance of each Gaussian in the picture, pixels squared, so that none is lost between pixels
// (Kerbl et al. 2023).
const float kGaussianLowPass = 0.3f;
// Smallest opacity that is drawn, and largest one.
const float kGaussianFaintest = 1.0f / 255;
const float kGaussianMostOpaque = 0.99f;
// Transmittance at which a pixel is complete: below a quarter of a step of eight bits.
const float kGaussianClosed = 1.0f / 1024;
// How far beyond the border of the picture, in its sizes, the projection is linearised where a Gaussian is (Kerbl et
// al. 2023).
const float kGaussianBeside = 0.15f;
// Larger determinants of a covariance on screen are out of the range of float: such Gaussians are left out.
const float kGaussianLargest = 1e36f;
// A point that was added after loading is drawn as a flat Gaussian: its standard deviations along the surface and
// across it, in spacings, and its opacity.
const float kNewGaussianWidth = 0.6f;
const float kNewGaussianHeight = 0.06f;
const float kNewGaussianOpacity = 0.95f;
// Bit of an owner that is too far for its motion and colour to be followed.
const uint kFarOwner = 0x80000000u;
const uint kNoOwner = 0xffffffffu;

// As loaded; model units relative to the cloud's origin.
struct Gaussian {
  vec3 center;
  float opacity;  // 0: not drawn
  vec4 rotation;  // x y z w, unit
  vec3 scale;     // standard deviations along its axes
  vec3 color;     // the harmonic of degree 0, as a colour from 0 to 1
  uint owner;     // the point that it belongs to, with kFarOwner; or kNoOwner
  uint beside;    // another point, by which the rotation about the owner's normal is seen; or kNoOwner
  uint across;    // a third point, by which its growth is seen; or kNoOwner
};
PALPATE_SIZE(Gaussian, 68);
// Largest change of the squares of a triangle's sides against one another if it grows, and the least growth that counts
// (GaussianEdit): a brush that bends a surface hardly scales it.
const float kGrownShape = 2e-3f;
const float kMinGrowth = 0.01f;

// In the picture, whose pixels have their centres at (x + 0.5, y + 0.5).
struct ProjectedGaussian {
  vec2 center_px;
  vec2 reach_px;  // half of the box in which it is not too faint
  vec3 shape;     // distances in standard deviations, across one another: x (dx - y dy) and z dy
  float opacity;
  vec2 slope;  // change of its mean depth along those
  float depth;
  uint redGreen, blue;  // half floats, as encoded for a screen
};
PALPATE_SIZE(ProjectedGaussian, 52);

#ifndef __cplusplus
// In standard deviations: where a Gaussian is too faint to be drawn.
float squaredReach(float opacity) { return 2 * log(opacity / kGaussianFaintest); }

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Gaussians { Gaussian at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ProjectedGaussians { ProjectedGaussian at[]; };
#endif

// The points of a cloud.
struct GaussianPoints {
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;  // RGBA8
};
PALPATE_SIZE(GaussianPoints, 24);

struct GaussianProjectArgs {
  PALPATE_ADDRESS(Gaussians) gaussians;
  PALPATE_ADDRESS(Uints) harmonics;  // (3 harmonicCount + 1) / 2 each: half floats, red green blue of each harmonic
  GaussianPoints now;
  GaussianPoints loaded;
  PALPATE_ADDRESS(ProjectedGaussians) projected;
  PALPATE_ADDRESS(Uints) keys;    // bits of the depth, or kNotProjected
  PALPATE_ADDRESS(Uints) values;  // indices
  uint count;                     // Gaussians, and points added after loading
  uint fileCount;                 // of them the Gaussians of the file
  uint loadedPoints;
  uint harmonicCount;  // of degree 1 and more
  float spacing;       // of the points, model units
  uint unused;
};
PALPATE_SIZE(GaussianProjectArgs, 112);
const uint kNotProjected = 0xffffffffu;

// A list of a bin is a bit for each Gaussian, nearest first.
struct GaussianBinArgs {
  PALPATE_ADDRESS(ProjectedGaussians) projected;
  PALPATE_ADDRESS(Uints) keys;  // sorted
  PALPATE_ADDRESS(Uints) order;
  PALPATE_ADDRESS(Vec4s) boxes;  // two of each, in that order: centre and half sides; shape and squared reach
  PALPATE_ADDRESS(Uints) bins;   // `words` for each bin
  uint count;
  uint words;
  uint binSide_px;
  uint binsAcross;
  uint binsDown;
  uint unused;
};
PALPATE_SIZE(GaussianBinArgs, 64);

struct GaussianBlendArgs {
  PALPATE_ADDRESS(ProjectedGaussians) projected;
  PALPATE_ADDRESS(Uints) order;
  PALPATE_ADDRESS(Vec4s) boxes;
  PALPATE_ADDRESS(Uints) bins;
  PALPATE_ADDRESS(Uints) depth;    // one per sample: bits of the depth at which half of the light is blocked
  PALPATE_ADDRESS(UVec2s) shaded;  // one per sample: linear light as four half floats; what is behind is there
  uint words;
  uint binSide_px;
  uint binsAcross;
  uint tilesAcross;
  uint tiles;
  uint unused;
};
PALPATE_SIZE(GaussianBlendArgs, 72);

PALPATE_SHARED_END
#endif
