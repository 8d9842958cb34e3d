#version 460
#extension GL_GOOGLE_include_directive : require
// The front point of the map in each pixel: the index image. One invocation for each slot of the live cloud, in three
// rounds, since atomics on 64 bits are not required. engine/motion/frame_fusion.cpp does the same on the host.
#include "shaders/lib/index.glsl"
#include "shaders/lib/fusion_buffers.glsl"
#include "shaders/shared/icp_passes.h"

layout(push_constant, scalar) uniform Push { MapFrontArgs args; };

void main() {
  const uint slot = threadIndex();
  if (slot >= args.slots) return;
  const vec4 position = args.positions.at[slot];
  const uint id = floatBitsToUint(position.w);
  if (id == kEmptySlot) return;
  const FusionView view = viewOf(args.view);
  const Projection projection = projectionOf(view, position.xyz);
  if (!projection.inView) return;
  const uint pixel = projection.pixel.y * view.width + projection.pixel.x;
  const uint depth = floatBitsToUint(projection.place.z);  // positive: its bits are ordered like its values
  if (args.turn != kFrontDepths && args.nearest.at[pixel] != depth) return;
  if (args.turn == kFrontPoints && args.ids.at[pixel] != id) return;
  const vec3 normal = args.normals.at[slot].xyz;
  if (!isFront(view, projection, normal)) return;
  if (args.turn == kFrontDepths) atomicMin(args.nearest.at[pixel], depth);
  if (args.turn == kFrontIds) atomicMin(args.ids.at[pixel], id);
  if (args.turn != kFrontPoints) return;
  args.frontPlaces.at[pixel] = vec4(position.xyz, args.records.at[id].weight);
  args.frontNormals.at[pixel] = vec4(normal, 0);
}
