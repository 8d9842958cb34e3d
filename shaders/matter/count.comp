#version 460
#extension GL_GOOGLE_include_directive : require
// The cell of each particle, which stands inside of periodic borders from then on.
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
    const vec3 inside = wrapped(cells, place);
    args.positions.at[i] += vec4(inside - place, 0);
    args.places.at[i] = vec4(inside, 0);
    place = inside;
  }
  const uint cell = numberOf(cells, cellOf(cells, place));
  args.cells.at[i] = cell;
  args.arrivals.at[i] = atomicAdd(args.firsts.at[cell], 1);
}
