#version 460
#extension GL_GOOGLE_include_directive : require
// Turns the number of particles of each cell into the first index of each, first half.
#include "shaders/lib/index.glsl"
#include "shaders/lib/tile_scan.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterScanArgs args; };

#include "shaders/lib/matter_setting.glsl"

void main() {
  const uint tile = workgroupIndex();
  if (tile < args.tiles && needsLists()) reduceTile(args.firsts, args.tileSums, tile, args.counts);
}
