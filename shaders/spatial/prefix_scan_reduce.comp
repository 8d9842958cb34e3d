#version 460
#extension GL_GOOGLE_include_directive : require
// Reduce-then-scan, first half: the sum of every tile.
#include "shaders/shared/prefix_scan.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/tile_scan.glsl"

layout(push_constant, scalar) uniform Push { PrefixScanArgs args; };

void main() {
  const uint tile = workgroupIndex();
  if (tile < args.tiles) reduceTile(args.values, args.tileSums, tile, args.count);
}
