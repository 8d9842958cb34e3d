// Picked splats, and the samples that an invocation walks for one. All splat passes see exactly the same fragments
// through this file.
#ifndef PALPATE_RENDER_SPLAT_GLSL
#define PALPATE_RENDER_SPLAT_GLSL
#include "shaders/lib/index.glsl"
#include "shaders/render/disc.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/shared/splat_radius.h"

layout(push_constant, scalar) uniform Push { SplatArgs args; };

// In [0, 1), and the same in every picture (after Jarzynski and Olano 2020, "Hash functions for GPU rendering", pcg).
float lotOf(uint point) {
  const uint state = point * 747796405u + 2891336453u;
  const uint word = (state >> (state >> 28) + 4 ^ state) * 277803737u;
  return float((word >> 22 ^ word) >> 8) / 16777216.0;
}

// Share of the points that are drawn for discs of this radius; above 1 all are.
float detailOf(float radius_px) {
  const float finer = radius_px / kFinestSplat;
  return frame.everyPoint != 0 ? 2 : kDetailCover * finer * finer;
}

float commonRadius() { return frame.splatRadius; }

// The radius of the widest disc among those of this point and its neighbours in memory, or of all.
float widthAround(uint point) {
  return commonRadius() > 0 ? commonRadius() : uintBitsToFloat(args.widths.at[point / kDiscBlock]);
}

// Whether a point may be drawn, by its position and its lot alone.
bool mayBeDrawn(RenderView view, uint point, vec3 position) {
  Disc disc;
  return placeDisc(view, position, disc) &&
         lotOf(point) < detailOf(widthAround(point) * (view.focal_px / divisorAt(view, disc.center.z)));
}

// The disc of a point as it is drawn; false if it is not drawn. Where points are finer than samples, points with low
// lots represent the others, at random but the same in every picture. A point fades before it is left out, so that
// nothing pops while the camera moves.
bool loadDisc(RenderView view, uint point, out Disc disc) {
  if (!placeDisc(view, args.positions.at[point].xyz, disc)) return false;
  const float lot = lotOf(point);
  const float unitPx = view.focal_px / divisorAt(view, disc.center.z);
  const uint hidesBacks = frame.hidesBacks;
  if (!orientDisc(view, args.normals.at[point], args.clips.at[point], commonRadius(), hidesBacks, disc)) return false;
  const float detail = detailOf(disc.radius * unitPx);
  if (lot >= detail) return false;
  disc.trust *= min(4 * (1 - lot / detail), 1);
  if (frame.everyPoint == 0) disc.radius = max(disc.radius, kFinestSplat / unitPx);
  return true;
}

const ivec2 kTile = ivec2(kSplatTileWidth, kSplatTileHeight);

// The radius of a disc in a crowd of large ones.
float radiusInCrowd(RenderView view, uint sharesOfEach, Disc disc) {
  const float unitPx = view.focal_px / divisorAt(view, disc.center.z);
  const float radius_px = min(disc.radius * unitPx, float(max(view.size_px.x, view.size_px.y)));
  const float most = float(kCrowdedRounds) * float(kSplatWalkers) * float(sharesOfEach);  // samples
  return min(args.counts.at[0].shrunk * radius_px, 0.5 * sqrt(most)) / unitPx;
}

struct Splat {
  uint point;
  Disc disc;
  PixelBox box;        // walked row by row, by one invocation or a few
  ivec2 pixel, stride;  // first pixel of this invocation, and its step
};

// Advances to the next pixel of this invocation; at the end it is past the box's last row.
void goOn(inout Splat splat) {
  splat.pixel += splat.stride;
  if (splat.pixel.x <= splat.box.last.x) return;
  splat.pixel.x -= splat.box.last.x - splat.box.first.x + 1;
  ++splat.pixel.y;
}

// The share of this invocation, in the pass over small or large splats; false if it has none. `view` is frame.view,
// held in registers by the caller.
bool loadSplat(RenderView view, bool large, out Splat splat) {
  const uint thread = args.turn * gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_WorkGroupSize.x + threadIndex();
  uint part = 0, sharesOfEach = 0;  // the tile, or in a crowd the share of this splat
  if (large) {
    const uint share = thread / kSplatWalkers;
    sharesOfEach = args.counts.at[0].sharesOfEach;
    if (share >= (sharesOfEach > 0 ? args.counts.at[0].large * sharesOfEach : args.counts.at[0].shares)) return false;
    const uint last = frame.count - 1;
    const uvec2 entry = sharesOfEach > 0 ? uvec2(args.picked.at[last - share / sharesOfEach], share % sharesOfEach)
                                         : args.shares.at[share];
    splat.point = entry.x;
    part = entry.y;
  } else {
    if (thread >= args.counts.at[0].small) return false;
    splat.point = args.picked.at[thread];
  }
  if (!loadDisc(view, splat.point, splat.disc)) return false;
  int walkers = large ? int(kSplatWalkers) : 1, walker = int(thread % uint(walkers));
  if (sharesOfEach > 0) {
    splat.disc.radius = radiusInCrowd(view, sharesOfEach, splat.disc);
    walker += walkers * int(part);
    walkers *= int(sharesOfEach);
  }
  splat.box = boxOf(view, splat.disc);
  if (large && sharesOfEach == 0) {
    // Tiles start at the first sample of the box, so that a splat of one tile has one share wherever it lies.
    const uint across = uint(splat.box.last.x - splat.box.first.x) / kSplatTileWidth + 1;
    splat.box.first += ivec2(part % across, part / across) * kTile;
    splat.box.last = min(splat.box.last, splat.box.first + kTile - 1);
  }
  const int width = splat.box.last.x - splat.box.first.x + 1;
  splat.pixel = splat.box.first + ivec2(walker % width, walker / width);
  splat.stride = ivec2(walkers % width, walkers / width);
  return true;
}

#endif
