#version 460
#extension GL_GOOGLE_include_directive : require
// The plan of a gather over buckets (thesis sections 4.3.2 and 4.3.3): the cells around the probe's first position, the
// candidates in each, the slots of their chunks in the patch, and the number of workgroups for that. One workgroup.
#include "shaders/lib/index.glsl"
#include "shaders/lib/probe.glsl"

layout(push_constant, scalar) uniform Push { GatherPlanArgs args; };
#include "shaders/lib/cells.glsl"

shared uint largest;

void writeCommand(uint command, uint x, uint y) {
  args.launch.at[3 * command] = x;
  args.launch.at[3 * command + 1] = y;
  args.launch.at[3 * command + 2] = 1;
}

void main() {
  const Probe probe = probeOf(args.pose, args.state, 0, args.radius);
  const vec3 centre = firstPlace(probe);
  const CellBox box = boxAround(probe.hip + centre, patchReach(args.radius), args.mostCells);
  const uint lane = scanIndex();
  if (lane == 0) largest = 0;

  uint listed = 0, segments = 0, steps = 0;
  bool thinned = false;
  for (uint first = 0; first < box.cells; first += kContactWorkgroup) {
    uint candidates;
    const uint total = loadRound(box, first, candidates);
    const uint stride = strideOf(total, kPatchRoundCandidates);
    thinned = thinned || stride > 1;
    steps += patchSteps(takenOf(total, stride));
    const uint start = cellStart[lane];
    const uint before = takenOf(start, stride);
    const uint taken = takenOf(start + candidates, stride) - before;
    const uint chunks = (taken + kGatherChunk - 1) / kGatherChunk;

    // One scan for two sums: chunks in the low half, cells with candidates in the high one.
    uint sums;
    const uint places = workgroupExclusiveScan(chunks | (taken > 0 ? 1u << 16 : 0u), sums);
    const uint c = first + lane;
    const uint entry = args.plan == kPlanList ? listed + (places >> 16) : c;
    if (c < box.cells && (args.plan != kPlanList || taken > 0)) {
      args.cells.at[entry].cell = cellAt(box, c);
      args.cells.at[entry].first = cellFirst[lane] + before * stride - start;
      args.cells.at[entry].stride = stride;
      args.cells.at[entry].taken = taken;
      args.cells.at[entry].segment = segments + (places & 0xffffu);
    }
    if (c < box.cells && args.plan == kPlanCommands) writeCommand(c, chunks, 1);
    if (taken > 0) atomicMax(largest, taken);
    listed += sums >> 16;
    segments += sums & 0xffffu;
    barrier();
  }
  if (args.plan == kPlanCommands)
    for (uint c = box.cells + lane; c < args.mostCells; c += kContactWorkgroup) writeCommand(c, 0, 1);

  barrier();
  if (lane != 0) return;
  if (args.plan == kPlanList) writeCommand(0, listed > 0 ? 1 : 0, listed);
  if (args.plan == kPlanCounts) {
    args.launch.at[0] = box.cells;
    args.launch.at[1] = largest;
  }
  args.gathered.header.centre = centre;
  args.gathered.header.hip = probe.hip;
  args.gathered.header.segments = segments;
  args.gathered.header.steps = steps;
  args.gathered.header.thinned = thinned ? 1 : 0;
}
