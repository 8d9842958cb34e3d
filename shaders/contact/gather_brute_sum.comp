#version 460
#extension GL_GOOGLE_include_directive : require
// Between the runs of the brute gather: turns the counts of its chunks into the first index of each. One workgroup;
// each invocation adds up a run of counts.
#include "shaders/lib/index.glsl"
#include "shaders/lib/probe.glsl"

layout(push_constant, scalar) uniform Push { GatherBruteArgs args; };
#include "shaders/lib/cells.glsl"

void main() {
  const uint each = (args.chunks + kContactWorkgroup - 1) / kContactWorkgroup;
  const uint begin = min(scanIndex() * each, args.chunks);
  const uint end = min(begin + each, args.chunks);
  uint sum = 0;
  for (uint i = begin; i < end; ++i) sum += args.starts.at[i];
  uint total;
  uint start = workgroupExclusiveScan(sum, total);
  for (uint i = begin; i < end; ++i) {
    const uint count = args.starts.at[i];
    args.starts.at[i] = start;
    start += count;
  }
  if (gl_LocalInvocationIndex != 0) return;
  args.starts.at[args.chunks] = total;
  const uint stride = strideOf(total, args.mostPoints);
  const uint taken = takenOf(total, stride);
  args.gathered.segments[0] = uvec2(0, taken);
  args.gathered.header.centre = firstPlace(probeOf(args.pose, args.state, 0, args.radius));
  args.gathered.header.segments = 1;
  args.gathered.header.steps = patchSteps(taken);
  args.gathered.header.thinned = stride > 1 ? 1 : 0;
}
