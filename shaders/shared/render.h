#ifndef PALPATE_SHARED_RENDER_H
#define PALPATE_SHARED_RENDER_H
#include "shaders/shared/mesh_vertex.h"
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// Samples in the box of a splat that one invocation walks alone. More let a few invocations delay their subgroup, fewer
// make the lists of shares longer.
const uint kSmallSplat = 16;
// A larger splat is walked in tiles of this size, in samples, each by kSplatWalkers invocations. Larger tiles let them
// occupy their workgroup, and delay the touch side, for longer; more invocations load the same disc more often.
const uint kSplatTileWidth = 16;
const uint kSplatTileHeight = 8;
const uint kSplatWalkers = 8;
// Capacity of the lists for tiles of all splats. If there are more, in a dense cluster of discs before the eye, all
// large splats are smaller by the same factor, so that as many tiles would do; they still cover the picture many times.
// Each then has the same number of shares, which walk no more than kCrowdedRounds samples for each invocation.
const uint kMaxShares = 1u << 20;
const uint kCrowdedRounds = 512;
const uint kSharesInBlock = 64;  // unit in which tiles are counted then
// Invocations of a workgroup that picks splats: more share one addition to the global counters.
const uint kPickWorkgroup = 512;
// Points that an invocation looks at when picking: more are in flight together, fewer end sooner.
const uint kPickPoints = 2;
// Workgroups in a row of a splat pass: one axis holds too few for all points.
const uint kSplatRow = 256;
// Splats are walked in this many rounds while a hand touches, since a contact step may have to wait for the end of one
// round. Each costs a few us.
const uint kSplatTurns = 6;
// Minimum radius of discs in the picture, samples. If a disc is smaller, only a share of the points is drawn that falls
// with the square of its radius. Larger blurs, smaller draws points that cannot be told apart.
const float kFinestSplat = 1;
// Factor on the number of points that would cover the picture as densely as discs of that radius do at full detail:
// points are chosen at random, so that fewer would leave gaps.
const float kDetailCover = 4;
// Triangles are walked in tiles of this many samples a side, by several invocations that share the tiles of one
// triangle.
const uint kTriangleTile = 16;
const uint kMaxTriangleTiles = 64;
const uint kMaxTriangleInvocations = 1u << 26;
// Weight of a splat that covers no pixel's centre, in the pixel of its own centre; a splat's middle has weight 1. If it
// is too large discs seen edge-on roughen the outline, if too small it is lost in fixed point.
const float kCenterPixelWeight = 0.25;
// Weight of a splat at its rim. Not zero, so that a sample covered only by rims still has a normal and a colour.
const float kRimWeight = 1.0f / 32;
// In its radii: how far behind the nearest splat another one still blends with it. Larger blends outliers away, smaller
// separates sheets that are close behind one another.
const float kDepthBand = 2;
// In usual radii: minimum depth behind the rim of a gap of what the gap shows. Less fills pits, more leaves gaps beside
// edges, where the inside of the other face is close.
const float kHoleDepth = 1;
// Largest gap that is closed: the trip count of an invocation is eight times this.
const uint kMaxHoleReach_px = 24;
// Largest window of the smoothing to each side, samples: the trip count is the square of twice this.
const uint kMaxSmooth_px = 16;
// Standard deviation in depth within which samples are smoothed together, in usual radii. Larger rounds steps off,
// smaller leaves the discs' rims.
const float kSmoothBand = 0.25f;
// Minimum weight of a fragment, in units of the sums, so that a sample covered only by such fragments keeps its normal
// and its colour.
const uint kMinWeight = 64;
// Maximum units in a weight of 1: if few fragments may meet in a sample.
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

// Source of the surface's colour.
const uint kColorByFile = 0;
const uint kColorByNormal = 1;
const uint kColorByDepth = 2;
const uint kColorByHeight = 3;
const uint kColorByMaterial = 4;

// How the surface sends light to the eye.
const uint kMaterialClay = 0;
const uint kMaterialStone = 1;
const uint kMaterialPlaster = 2;
const uint kMaterialMetal = 3;
const uint kMaterialUnlit = 4;
const uint kMaterialWater = 5;

// What the points of a cloud have (RenderFrame::shown).
const uint kShownColors = 1;    // colours of their own
const uint kShownSelected = 2;  // a mask: tinted
const uint kShownHidden = 4;    // a mask: not drawn
const uint kShownField = 8;     // numbers, shown in place of their own colours
const uint kShownLock = 16;     // weights of locks: shaded
// Colour of selected points, sRGB, and its share.
const vec3 kSelectedColor = vec3(1.0f, 0.55f, 0.1f);
const float kSelectedShare = 0.6f;
// The same of points that are wholly locked.
const vec3 kLockColor = vec3(0.12f, 0.14f, 0.2f);
const float kLockShare = 0.7f;
// In its place for those that are selected, too: of the hue of the selection, as dark as a lock, so that both are seen.
const vec3 kSelectedLockColor = vec3(0.36f, 0.14f, 0.0f);

// A pinhole camera, or an orthographic one. Eye space: x right, y up, depth along `forward`; pixel (x, y) has its
// centre at (x + 0.5, y + 0.5), y downwards. Positions are model units relative to the cloud's origin.
struct RenderView {
  vec3 eye;
  float focal_px;  // pixels that one unit covers at depth 1; orthographic: at any depth
  vec3 right;
  float nearDepth;  // nothing closer is drawn
  vec3 up;
  uint supersample;  // samples along each side of a pixel of the picture
  vec3 forward;
  uint isOrthographic;
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
  vec3 barColor;  // sRGB
  uint unused;
};
PALPATE_SIZE(RenderOverlays, 144);

// The constants of a picture (shaders/render/frame_block.glsl).
struct RenderFrame {
  RenderView view;
  RenderOverlays overlays;
  vec3 boundsMin;  // of the part of the cloud that is to be seen
  float depthMin;  // of the bounds, for the ramps
  vec3 boundsMax;
  float depthMax;
  vec3 up;             // unit, along an axis: heights are along it
  float splatRadius;   // of every point, model units; 0: each has its own
  float widestSplat;   // largest radius of a disc, model units
  uint everyPoint;     // not 0: points are not subsampled where they are finer than samples
  float usualRadius;   // of discs and gaps: unit of lengths that depend on the spacing of points, model units
  float sumScale;      // fixed-point unit of the sums of triangles
  uint count;          // points, or triangles
  uint triangleTiles;  // tiles along each side of the largest triangle
  uint imagePass;
  uint colorBy;
  uint hasColors;         // not 0: colours are summed
  vec3 baseColor;         // of points without colour, linear light
  uint shown;             // kShown* of the points
  vec3 backgroundTop;     // linear light
  float occlusionRadius;  // model units; 0: none
  vec3 backgroundBottom;
  uint holeReach_px;  // radius of the gaps that are closed, samples; 0: no closing
  uint smooth_px;  // to each side, samples: depth is smoothed, and normals follow from it; 0: they are the blended ones
  PALPATE_ADDRESS(Uints) selected;  // a bit for each point, like the next
  PALPATE_ADDRESS(Uints) hidden;
  PALPATE_ADDRESS(Uints) lock;    // a byte for each point: 255 is wholly locked
  PALPATE_ADDRESS(Uints) values;  // bits of a float for each point; NaN: no number
  float lowValue, highValue;      // ends of the ramp
  uint colorMap;                  // kMap* of the ramp
  uint material;                  // kMaterial*
  uint unpainted;                 // baseColor as RGBA8: what points show that carry kUnpainted
  float backgroundOpacity;        // 1, or 0 for a transparent background, whose light is 0 as well
  uint firstDisc;                 // points before it are drawn otherwise
  uint hidesBacks;                // not 0: no surface is drawn from its back
};
PALPATE_SIZE(RenderFrame, 80 + 144 + 44 + 40 + 52 + 64);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Floats { float at[]; };
#endif

// Result of the picking pass. Splats are small or large; a large one is also listed by its tiles, the shares.
struct SplatCounts {
  uint small, large;
  uint shares;                          // may exceed kMaxShares; the list ends there
  float sumScale;                       // fixed-point unit of their sums
  uint smallGroups[3], largeGroups[3];  // workgroups that walk them, in each round
  uint blocks;                          // of kSharesInBlock tiles: of all large splats
  uint sharesOfEach;                    // of a large splat, if too many tiles are listed; else 0
  float shrunk;                         // factor on the radius of large splats then
};
PALPATE_SIZE(SplatCounts, 52);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SplatCountsAt { SplatCounts at[]; };
#endif

struct SplatArgs {
  PALPATE_ADDRESS(SplatCountsAt) counts;  // one
  PALPATE_ADDRESS(Uints) picked;          // one per point: small splats from the front, large ones from the back
  PALPATE_ADDRESS(UVec2s) shares;         // kMaxShares: point and tile
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;      // RGBA8
  PALPATE_ADDRESS(Uints) clips;       // where discs are clipped, in pairs of half floats
  PALPATE_ADDRESS(Uints) widths;      // one per kDiscBlock points: bits of their largest radius
  PALPATE_ADDRESS(Uints) depth;       // one per sample: bits of the nearest depth
  PALPATE_ADDRESS(Uints) normalSums;  // four per sample (shaders/render/sums.glsl)
  PALPATE_ADDRESS(Uints) colorSums;   // three per sample
  uint turn;                          // round of those that walk splats
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

// Triangles are drawn by tiles, like splats; a triangle with more tiles than invocations is walked in several rounds.
struct TriangleArgs {
  PALPATE_ADDRESS(MeshVertices) vertices;
  PALPATE_ADDRESS(Uints) triangles;
  PALPATE_ADDRESS(Uints) depth;  // as in SplatArgs, like the sums
  PALPATE_ADDRESS(Uints) normalSums;
  PALPATE_ADDRESS(Uints) colorSums;
};
PALPATE_SIZE(TriangleArgs, 40);

struct CloseHolesArgs {
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(Uints) source;  // one per sample: the sample whose surface it shows, usually itself
};
PALPATE_SIZE(CloseHolesArgs, 16);

struct SmoothDepthArgs {
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(Uints) smoothed;  // one per sample, like the depth
};
PALPATE_SIZE(SmoothDepthArgs, 16);

struct ShadeArgs {
  PALPATE_ADDRESS(Uints) source;
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(Uints) normalSums;
  PALPATE_ADDRESS(Uints) colorSums;
  PALPATE_ADDRESS(UVec2s) shaded;  // one per sample: linear light as four half floats
  // Of Relief, one per pixel; null: not made.
  PALPATE_ADDRESS(UVec2s) surfels;
  PALPATE_ADDRESS(Floats) access;
  PALPATE_ADDRESS(Floats) cavity;
};
PALPATE_SIZE(ShadeArgs, 64);

struct ResolveArgs {
  PALPATE_ADDRESS(Uints) source;  // null: each sample shows its own surface
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(UVec2s) shaded;
  PALPATE_ADDRESS(Uints) image;        // one per pixel: RGBA8
  PALPATE_ADDRESS(Floats) depthImage;  // one per pixel: the nearest sample's depth, 0 where there is none
  uvec2 first_px;                      // the rectangle of pixels to resolve
  uvec2 size_px;
};
PALPATE_SIZE(ResolveArgs, 56);

// Thin lines in space, clipped at the border of the picture. The maximum width is kWidestLine_px; each line is walked
// by kLineWalkers invocations, side by side.
const float kWidestLine_px = 16;
const uint kLineWalkers = 32;
// Factor on the opacity of a line behind the surface.
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
  PALPATE_ADDRESS(RenderLines) lines;
  PALPATE_ADDRESS(Uints) marks;        // one per pixel: opacity of the line there, then its colour; 0: none
  PALPATE_ADDRESS(Floats) depthImage;  // as in ResolveArgs, like the image
  PALPATE_ADDRESS(Uints) image;
  uint count;  // lines
  uint unused;
};
PALPATE_SIZE(LineArgs, 40);

PALPATE_SHARED_END
#endif
