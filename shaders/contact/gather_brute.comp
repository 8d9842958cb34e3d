#version 460
#extension GL_GOOGLE_include_directive : require
// The brute gather (thesis section 4.3.1): visits every point of the cloud. Run twice, with a sum of the counts in
// between: the first run counts the points that each chunk keeps, the second writes them to the summed indices.
#include "shaders/lib/index.glsl"
#include "shaders/lib/probe.glsl"

layout(push_constant, scalar) uniform Push { GatherBruteArgs args; };
#include "shaders/lib/cells.glsl"

void main() {
  const uint chunk = workgroupIndex();
  if (chunk >= args.chunks) return;
  uint place = 0;
  if (args.fill != 0) {
    place = args.starts.at[chunk];
    if (place == args.starts.at[chunk + 1]) return;
  }
  const Probe probe = probeOf(args.pose, args.state, 0, args.radius);
  const vec3 centre = firstPlace(probe);
  const float reach = patchReach(args.radius);
  const uint stride = args.fill != 0 ? strideOf(args.starts.at[args.chunks], args.mostPoints) : 1;
  uint count = 0;
  for (uint item = 0; item < kBruteItems; ++item) {
    const uint i = chunk * kBruteChunk + item * kContactWorkgroup + scanIndex();
    vec4 at = vec4(0.0);
    bool keep = false;
    if (i < args.cloud.slots) {
      const vec4 position = args.cloud.positions.at[i];
      at = vec4(placeInPatch(position.xyz, probe.hip, centre), position.w);
      keep = floatBitsToUint(position.w) != kEmptySlot && inReach(at.xyz, reach);
    }
    if (args.fill == 0) {
      count += keep ? 1 : 0;
      continue;
    }
    uint kept;
    const uint index = place + workgroupExclusiveScan(keep ? 1 : 0, kept);
    place += kept;
    if (!keep || index % stride != 0) continue;
    const uint slot = index / stride;
    args.gathered.points[2 * slot] = at;
    args.gathered.points[2 * slot + 1] = vec4(args.cloud.normals.at[i].xyz, 0.0);
  }
  if (args.fill != 0) return;
  uint total;
  workgroupExclusiveScan(count, total);
  if (gl_LocalInvocationIndex == 0) args.starts.at[chunk] = total;
}
