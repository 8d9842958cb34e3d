#version 460
#extension GL_GOOGLE_include_directive : require
// Gathers the candidates of planned cells into the patch: one row of workgroups for each cell, its chunks over the
// workgroups of the row, one invocation for each candidate. A chunk's points go to its own slots in their order, so
// that the order of the workgroups does not matter.
#include "shaders/lib/index.glsl"
#include "shaders/lib/contact_buffers.glsl"

layout(push_constant, scalar) uniform Push { GatherBucketsArgs args; };
#include "shaders/lib/cells.glsl"

void main() {
  const uint entry = args.firstCell + gl_WorkGroupID.y;
  const ivec3 cell = args.cells.at[entry].cell;
  const uint first = args.cells.at[entry].first;
  const uint stride = args.cells.at[entry].stride;
  const uint taken = args.cells.at[entry].taken;
  const uint segment = args.cells.at[entry].segment;
  const vec3 hip = args.gathered.header.hip;
  const vec3 centre = args.gathered.header.centre;
  const float reach = patchReach(args.radius);
  for (uint chunk = gl_WorkGroupID.x; chunk * kGatherChunk < taken; chunk += gl_NumWorkGroups.x) {
    const uint k = chunk * kGatherChunk + scanIndex();
    const uint i = first + k * stride;
    bool keep = false;
    vec4 place;
    if (k < taken) {
      const vec4 position = args.cloud.positions.at[i];
      place = vec4(placeInPatch(position.xyz, hip, centre), position.w);
      // Another cell of this gather may share the bucket: its points are taken once, with that cell.
      keep = cellOf(args.cloud.grid, position.xyz) == cell && inReach(place.xyz, reach);
    }
    const uint slot = (segment + chunk) * kGatherChunk;
    uint kept;
    const uint at = slot + workgroupExclusiveScan(keep ? 1 : 0, kept);
    if (keep) {
      args.gathered.points[2 * at] = place;
      args.gathered.points[2 * at + 1] = vec4(args.cloud.normals.at[i].xyz, 0.0);
    }
    if (gl_LocalInvocationIndex == 0) args.gathered.segments[segment + chunk] = uvec2(slot, kept);
  }
}
