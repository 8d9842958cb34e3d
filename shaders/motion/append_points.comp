#version 460
#extension GL_GOOGLE_include_directive : require
// Creates a new point for each pixel that needs one, while there is room.
#include "shaders/lib/index.glsl"
#include "shaders/lib/fusion_buffers.glsl"

layout(push_constant, scalar) uniform Push { AppendPointsArgs args; };

shared uint appendedPoints, refusedPoints;

bool append(uint pixel, uint rank) {
  const uvec2 place = args.places.at[rank];
  if (place.x == kEmptySlot || place.y == kEmptySlot) return false;
  const FusionView view = viewOf(args.view);
  Measurement measured;
  measured.pixel = uvec2(pixel % view.width, pixel / view.width);
  measured.depth = args.depths.at[pixel];
  measured.color = view.colored != 0 ? args.colors.at[pixel] : 0;
  measured.surface = surfaceAt(args.surfaces, pixel);
  const Surfel surfel = bornAt(view, measured);
  args.positions.at[place.y] = vec4(surfel.place, uintBitsToFloat(place.x));
  args.normals.at[place.y] = vec4(surfel.normal, uintBitsToFloat(colorBeside(surfel.record)));
  args.records.at[place.x] = surfel.record;
  if (view.felt != 0) {  // it is there at once, without motion
    args.velocities.at[place.x] = vec4(0.0, 0.0, 0.0, 1.0);
    args.velocities.at[args.slots + place.x] = vec4(0.0);
  }
  return true;
}

void main() {
  if (gl_LocalInvocationIndex == 0) appendedPoints = refusedPoints = 0;
  barrier();
  const uint pixel = threadIndex();
  if (pixel < args.pixels) {
    const uint word = pixel / kMaskBits, bit = pixel % kMaskBits;
    const uint mask = args.newPixels.at[word];
    if ((mask >> bit & 1u) != 0) {
      const uint rank = args.newBefore.at[word] + bitCount(mask & ((1u << bit) - 1u));
      if (append(pixel, rank))
        atomicAdd(appendedPoints, 1);
      else
        atomicAdd(refusedPoints, 1);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex != 0) return;
  if (appendedPoints > 0) atomicAdd(args.totals.now.appended, appendedPoints);
  if (refusedPoints > 0) atomicAdd(args.totals.now.refused, refusedPoints);
}
