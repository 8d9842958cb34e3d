#ifndef PALPATE_SHARED_RENDER_H
#define PALPATE_SHARED_RENDER_H
#include "shaders/shared/mesh_vertex.h"
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// Samples in the box of a splat that one invocation walks alone. More let a few invocations hold their subgroup up,
// fewer make the lists of shares longer.
const uint kSmallSplat = 16;
// A larger splat is walked in tiles of so many samples, each by a few invocations. Larger tiles let them hold their
// workgroup, and with it the touch side, for longer; more invocations load the same disc more often.
const uint kSplatTileWidth = 16;
const uint kSplatTileHeight = 8;
const uint kSplatWalkers = 8;
// Side of the square that a splat covers at most, samples. What is beyond is cut off.
const uint kMaxSplat = 1024;
// Tiles of all splats that the lists have room for. Where there are more, in a heap of discs before the eye, each is
// cut off to a square of this side around its middle.
const uint kMaxShares = 1u << 20;
const uint kCrowdedSplat = 64;
// Invocations of a workgroup that picks splats: more share one addition to the global counters.
const uint kPickWorkgroup = 512;
// Workgroups in a row of a splat pass: one axis holds too few for all points.
const uint kSplatRow = 256;
// Splats are walked in so many turns while somebody touches, who may have to wait for the end of one. Each costs a few
// us.
const uint kSplatTurns = 6;
// Samples. Discs never have a smaller radius in the picture; where theirs is, a share of the points is drawn that falls
// with its square. Larger blurs, smaller draws points that nobody can tell apart.
const float kFinestSplat = 1;
// Of the points that would cover the picture as densely as discs of that radius do at full detail, so many times as
// many are drawn: as they are chosen at random, fewer leave gaps.
const float kDetailCover = 4;
// Triangles are walked in tiles of this many samples a side, by invocations that share those of one.
const uint kTriangleTile = 16;
const uint kMaxTriangleTiles = 64;
const uint kMaxTriangleInvocations = 1u << 26;
// Weight of a splat that covers no pixel's centre in the pixel where its own centre lies; a splat's middle has weight
// 1. Too large and discs seen on edge roughen the outline, too small and it is lost in fixed point.
const float kCenterPixelWeight = 0.25;
// Weight of a splat at its rim. Not zero, so that a sample which only rims cover still has a normal and a colour.
const float kRimWeight = 1.0f / 32;
// In its radii: how far behind the nearest splat another one still blends with it. Larger blends outliers that stand
// out away, smaller keeps sheets apart that lie close behind one another.
const float kDepthBand = 2;
// In usual radii: what a gap shows lies so far behind its rim at least. Less fills pits, more leaves gaps beside edges,
// where the inside of the other face is close.
const float kHoleDepth = 1;
// Largest gap that is closed: the trip count of an invocation is eight times this.
const uint kMaxHoleReach_px = 24;
// Largest window of the smoothing to each side, samples: its trip count is the square of twice this.
const uint kMaxSmooth_px = 16;
// Deviation in depth within which samples are smoothed together, in usual radii. Larger rounds steps off, smaller
// leaves the discs' rims.
const float kSmoothBand = 0.25f;
// The least weight of a fragment, in units of the sums, so that a sample which only such fragments cover keeps its
// normal and its colour.
const uint kMinWeight = 64;
// Units in a weight of 1, at most: where few fragments may meet in a sample.
const uint kFinestSum = 1u << 16;
// Depth of a pixel that nothing covers: the bits of +infinity, above those of every depth.
const uint kNoDepth = 0x7F800000u;

// What a picture shows.
const uint kPassFinal = 0;
const uint kPassDepth = 1;
const uint kPassNormal = 2;
const uint kPassColor = 3;
const uint kPassPosition = 4;
const uint kPassSmoothDepth = 5;

// Where the colour of the surface comes from.
const uint kColorByFile = 0;
const uint kColorByNormal = 1;
const uint kColorByDepth = 2;
const uint kColorByHeight = 3;

// A pinhole camera. Eye space: x right, y up, depth along `forward`; pixel (x, y) has its centre at (x + 0.5, y + 0.5),
// y downwards. Positions are model units relative to the cloud's origin.
struct RenderView {
  vec3 eye;
  float focal_px;  // pixels that one unit covers at depth 1
  vec3 right;
  float nearDepth;  // nothing closer is drawn
  vec3 up;
  uint supersample;  // samples along each side of a pixel of the picture
  vec3 forward;
  uint unused;
  vec2 center_px;
  uvec2 size_px;  // in samples
};
PALPATE_SIZE(RenderView, 80);

// What is drawn over the surface; a radius of zero leaves a part out. Model units relative to the cloud's origin.
struct RenderOverlays {
  vec3 ballCenter;
  float ballRadius;
  vec3 discCenter;
  float discRadius;
  vec3 discNormal;
  float discHalfThickness;
  vec3 arrowFrom;
  float arrowRadius;    // of the shaft
  vec3 arrowDirection;  // unit
  float arrowLength;    // with its head
  vec3 brushCenter;
  float brushRadius;  // of a ball that shows as its outline
  vec3 barFrom;
  float barRadius;
  vec3 barDirection;  // unit
  float barLength;
};
PALPATE_SIZE(RenderOverlays, 128);

// One frame's constants. The parts that shaders load whole come first: the validation layer of Debian 12 takes such a
// load for larger than it is and reports one at the end of a buffer.
struct RenderFrame {
  RenderView view;
  RenderOverlays overlays;
  vec3 boundsMin;  // of what is to be seen of the cloud
  float depthMin;  // of the bounds, for the ramps
  vec3 boundsMax;
  float depthMax;
  vec3 up;             // unit, along an axis: heights are along it
  float splatRadius;   // of every point, model units; 0: each has its own
  float widestSplat;   // largest radius of a disc, model units
  uint everyPoint;     // not 0: no point is left out where they are finer than samples
  float usualRadius;   // of discs and gaps: lengths that follow from how far apart points are, model units
  float sumScale;      // fixed-point unit of the sums of triangles
  uint count;          // points, or triangles
  uint triangleTiles;  // tiles along each side of the largest triangle
  uint imagePass;
  uint colorBy;
  uint hasColors;
  vec3 material;  // of points without colour, linear light
  uint unused;
  vec3 backgroundTop;     // linear light
  float occlusionRadius;  // model units; 0: none
  vec3 backgroundBottom;
  uint holeReach_px;  // radius of the gaps that are closed, samples; 0: none are
  uint smooth_px;  // to each side, samples: depth is smoothed, and normals follow from it; 0: they are the blended ones
};
PALPATE_SIZE(RenderFrame, 80 + 128 + 44 + 40 + 52);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer RenderFrames { RenderFrame at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Floats { float at[]; };
#endif

// What the picking pass finds. Splats are small or large; a large one is also listed by its tiles, the shares.
struct SplatCounts {
  uint small, large;
  uint shares;                          // may exceed kMaxShares; the list ends there
  float sumScale;                       // fixed-point unit of their sums
  uint smallGroups[3], largeGroups[3];  // workgroups that walk them, in each turn
};
PALPATE_SIZE(SplatCounts, 40);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SplatCountsAt { SplatCounts at[]; };
#endif

struct SplatArgs {
  PALPATE_ADDRESS(RenderFrames) frame;
  PALPATE_ADDRESS(SplatCountsAt) counts;  // one
  PALPATE_ADDRESS(Uints) picked;          // one per point: small splats from the front, large ones from the back
  PALPATE_ADDRESS(UVec2s) shares;         // kMaxShares: point and tile
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;      // RGBA8
  PALPATE_ADDRESS(Uints) clips;       // where discs are cut off, in pairs of half floats
  PALPATE_ADDRESS(Uints) depth;       // one per sample: bits of the nearest depth
  PALPATE_ADDRESS(Uints) normalSums;  // four per sample (shaders/render/sums.glsl)
  PALPATE_ADDRESS(Uints) colorSums;   // three per sample
  uint turn;                          // of those that walk splats
  uint unused;
};
PALPATE_SIZE(SplatArgs, 96);

struct SplatPlanArgs {
  PALPATE_ADDRESS(SplatCountsAt) counts;
  uint smallsPerGroup, largesPerGroup;  // splats that a workgroup walks
  uint turns;
  uint unused;
};
PALPATE_SIZE(SplatPlanArgs, 24);

// Triangles are drawn by tiles as splats are; one that is larger than its tiles is walked in more rounds.
struct TriangleArgs {
  PALPATE_ADDRESS(RenderFrames) frame;
  PALPATE_ADDRESS(MeshVertices) vertices;
  PALPATE_ADDRESS(Uints) triangles;
  PALPATE_ADDRESS(Uints) depth;  // as in SplatArgs, and so the sums
  PALPATE_ADDRESS(Uints) normalSums;
  PALPATE_ADDRESS(Uints) colorSums;
};
PALPATE_SIZE(TriangleArgs, 48);

struct CloseHolesArgs {
  PALPATE_ADDRESS(RenderFrames) frame;
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(Uints) source;  // one per sample: the sample whose surface it shows, mostly itself
};
PALPATE_SIZE(CloseHolesArgs, 24);

struct SmoothDepthArgs {
  PALPATE_ADDRESS(RenderFrames) frame;
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(Uints) smoothed;  // one per sample, as the depth
};
PALPATE_SIZE(SmoothDepthArgs, 24);

struct ShadeArgs {
  PALPATE_ADDRESS(RenderFrames) frame;
  PALPATE_ADDRESS(Uints) source;
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(Uints) normalSums;
  PALPATE_ADDRESS(Uints) colorSums;
  PALPATE_ADDRESS(UVec2s) shaded;  // one per sample: linear light as four half floats
};
PALPATE_SIZE(ShadeArgs, 48);

struct ResolveArgs {
  PALPATE_ADDRESS(RenderFrames) frame;
  PALPATE_ADDRESS(Uints) source;
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(UVec2s) shaded;
  PALPATE_ADDRESS(Uints) image;        // one per pixel: RGBA8
  PALPATE_ADDRESS(Floats) depthImage;  // one per pixel: the nearest sample's depth, 0 where there is none
  uvec2 first_px;                      // the pixels that are resolved: of a rectangle
  uvec2 size_px;
};
PALPATE_SIZE(ResolveArgs, 64);

// Thin lines in space, cut off where they leave the picture. The widest is so many pixels; each is walked by a few
// invocations, side by side.
const float kWidestLine_px = 16;
const uint kLineWalkers = 32;
// Of a line that lies behind the surface: how much of it shines through.
const float kHiddenLine = 0.25f;

struct RenderLine {
  vec3 from;   // in eye space
  uint color;  // RGB8, red in the lowest byte, as encoded for a screen; the highest byte is how opaque it is
  vec3 to;
  float width_px;
};
PALPATE_SIZE(RenderLine, 32);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer RenderLines { RenderLine at[]; };
#endif

struct LineArgs {
  PALPATE_ADDRESS(RenderFrames) frame;
  PALPATE_ADDRESS(RenderLines) lines;
  PALPATE_ADDRESS(Uints) marks;        // one per pixel: how opaque the line there is, then its colour; 0: none
  PALPATE_ADDRESS(Floats) depthImage;  // as in ResolveArgs, and so the image
  PALPATE_ADDRESS(Uints) image;
  uint count;  // lines
  uint unused;
};
PALPATE_SIZE(LineArgs, 48);

PALPATE_SHARED_END
#endif
