#version 460
#extension GL_GOOGLE_include_directive : require
// The cell of each particle; the predicted positions are wrapped into periodic borders here.
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterCountArgs args; };

#include "shaders/lib/matter_setting.glsl"

void main() {
  const uint i = threadIndex();
  if (i >= args.particles || !needsLists()) return;
  const MatterCells cells = particleCells();
  vec3 place = args.places.at[i].xyz;
  if (cells.periodic != 0) {
    place = wrapped(cells, place);
    args.places.at[i] = vec4(place, 0);
  }
  const uint cell = numberOf(cells, cellOf(cells, place));
  args.cells.at[i] = cell;
  args.arrivals.at[i] = atomicAdd(args.firsts.at[cell], 1);
}
