// The square of pixels that one invocation walks for one disc. Both splat passes see exactly the same fragments through
// this file.
#ifndef PALPATE_RENDER_SPLAT_GLSL
#define PALPATE_RENDER_SPLAT_GLSL
#include "shaders/lib/index.glsl"
#include "shaders/render/disc.glsl"

layout(push_constant, scalar) uniform Push { SplatArgs args; };

struct Splat {
  uint point;
  Disc disc;
  PixelBox box;  // to walk
};

// This invocation's share of a splat; false when it has none. `view` is frame.view, held in registers by the caller.
bool loadSplat(RenderView view, out Splat splat) {
  const uint tiles = args.frame.at[0].splatTiles;
  const uint thread = threadIndex();
  splat.point = thread / (tiles * tiles);
  if (splat.point >= args.frame.at[0].count) return false;
  if (!placeDisc(view, args.positions.at[splat.point].xyz, splat.disc)) return false;
  orientDisc(view, args.normals.at[splat.point], args.clips.at[splat.point], args.frame.at[0].splatRadius, splat.disc);

  splat.box = boxOf(view, splat.disc);
  const int side = int(tiles * kSplatTile);
  const ivec2 corner = splat.disc.centerPixel - side / 2;  // of the square that all shares together can walk
  splat.box.first = max(splat.box.first, corner);
  splat.box.last = min(splat.box.last, corner + side - 1);

  // Shares start at the first visible pixel, so that a splat of one tile has one share wherever it lies.
  const uint share = thread % (tiles * tiles);
  splat.box.first += ivec2(share % tiles, share / tiles) * int(kSplatTile);
  splat.box.last = min(splat.box.last, splat.box.first + int(kSplatTile) - 1);
  return all(lessThanEqual(splat.box.first, splat.box.last));
}

#endif
