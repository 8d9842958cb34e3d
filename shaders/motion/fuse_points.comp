#version 460
#extension GL_GOOGLE_include_directive : require
// Every point of the map looks up its pixel in the frame: it is averaged with the measurement there, stays as it is, or
// is removed. One invocation for each slot of the live cloud; nothing depends on their order, since bits are set and
// integers added.
#include "shaders/lib/index.glsl"
#include "shaders/lib/fusion_buffers.glsl"

layout(push_constant, scalar) uniform Push { FusePointsArgs args; };

// Empty slots of the workgroup, 32 a word; and counts of its points.
shared uint emptyMask[kMaxMaskWords];
shared uint matchedPoints, removedPoints;

uint pixelIndex(FusionView view, uvec2 pixel) { return pixel.y * view.width + pixel.x; }

// Whether no depth around the pixel hides a position at that depth.
bool seesThroughAt(FusionView view, uvec2 pixel, float placeDepth) {
  const uvec2 first = max(pixel, uvec2(1)) - 1, last = min(pixel + 1, uvec2(view.width, view.height) - 1);
  for (uint y = first.y; y <= last.y; ++y)
    for (uint x = first.x; x <= last.x; ++x)
      if (!seesThrough(view, placeDepth, args.depths.at[pixelIndex(view, uvec2(x, y))])) return false;
  return true;
}

// kSight... of a point that is in view; if it was measured, `surfel` is updated.
uint look(FusionView view, Projection projection, inout Surfel surfel) {
  const uint pixel = pixelIndex(view, projection.pixel);
  Measurement measured;
  measured.pixel = projection.pixel;
  measured.depth = args.depths.at[pixel];
  if (!(measured.depth > 0)) return kSightNone;
  measured.surface = surfaceAt(args.surfaces, pixel);
  const Sight sight = sightOf(view, projection, directionInCamera(view, surfel.normal), measured);
  if (sight.covers) atomicOr(args.covered.at[pixel], projection.part);
  if (sight.kind == kSightMatched) {
    measured.color = view.colored != 0 ? args.colors.at[pixel] : 0;
    surfel = averaged(view, surfel, measured);
  }
  if (sight.kind == kSightFree && !seesThroughAt(view, projection.pixel, projection.place.z)) return kSightUnclear;
  return sight.kind;
}

// The motion of a point that stays, from its position before the frame.
void sendOn(FusionView view, uint id, vec3 place, vec3 normal, vec3 toPlace, vec3 toNormal) {
  SurfelWay way;
  way.velocity = args.velocitiesIn.at[id].xyz;
  way.turn = args.velocitiesIn.at[args.slots + id].xyz;
  const SurfelWay on = wayOn(view, place, normal, way, toPlace, toNormal);
  args.velocitiesOut.at[id] = vec4(on.velocity, 1.0);
  args.velocitiesOut.at[args.slots + id] = vec4(on.turn, 0.0);
}

// Updates a point and its record. Whether it stays.
bool fusePoint(FusionView view, inout vec4 position, inout vec4 normal) {
  const Projection projection = projectionOf(view, position.xyz);
  if (!projection.inView) return true;
  const uint id = floatBitsToUint(position.w);
  Surfel surfel;
  surfel.place = position.xyz;
  surfel.normal = normal.xyz;
  surfel.record = args.records.at[id];
  const uint sight = look(view, projection, surfel);
  if (sight == kSightNone) return true;
  if (sight == kSightMatched) {
    position.xyz = surfel.place;
    normal = vec4(surfel.normal, uintBitsToFloat(colorBeside(surfel.record)));
    args.records.at[id] = surfel.record;
    atomicAdd(matchedPoints, 1);
    return true;
  }
  const SurfelRecord record = doubted(surfel.record, sight);
  if (record.counts != surfel.record.counts) args.records.at[id] = record;
  if (!isGivenUp(record)) return true;
  atomicOr(args.freeIds.at[id / kMaskBits], 1u << id % kMaskBits);
  atomicAdd(removedPoints, 1);
  return false;
}

// Whether the slot has a point afterwards.
bool fuseSlot(uint slot) {
  // Loads both at once, needed or not, so that their latencies overlap.
  vec4 position = args.positionsIn.at[slot], normal = args.normalsIn.at[slot];
  const vec4 positionBefore = position, normalBefore = normal;
  const FusionView view = viewOf(args.view);
  const bool stays = floatBitsToUint(position.w) != kEmptySlot && fusePoint(view, position, normal);
  if (stays && view.felt != 0)
    sendOn(view, floatBitsToUint(position.w), positionBefore.xyz, normalBefore.xyz, position.xyz, normal.xyz);
  args.positionsOut.at[slot] = stays ? position : vec4(0, 0, 0, uintBitsToFloat(kEmptySlot));
  args.normalsOut.at[slot] = stays ? normal : vec4(0);
  return stays;
}

void main() {
  const uint local = gl_LocalInvocationIndex, words = gl_WorkGroupSize.x / kMaskBits;
  if (local < words) emptyMask[local] = 0;
  if (local == 0) matchedPoints = removedPoints = 0;
  barrier();
  const uint slot = threadIndex();
  if (slot < args.slots && !fuseSlot(slot)) atomicOr(emptyMask[local / kMaskBits], 1u << local % kMaskBits);
  barrier();
  const uint word = (slot - local) / kMaskBits + local;
  if (local < words && word * kMaskBits < args.slots) args.emptySlots.at[word] = emptyMask[local];
  if (local != 0) return;
  if (matchedPoints > 0) atomicAdd(args.totals.now.matched, matchedPoints);
  if (removedPoints > 0) atomicAdd(args.totals.now.removed, removedPoints);
}
