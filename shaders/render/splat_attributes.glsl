// Surface splatting in compute, pass 4: fragments close behind the nearest one add their normal and colour, weighted by
// a smooth falloff, so that neighbouring discs blend into one surface.
#include "shaders/render/frame_block.glsl"
#include "shaders/render/shown.glsl"
#include "shaders/render/splat.glsl"
#include "shaders/render/sums.glsl"

layout(constant_id = 1) const bool kLarge = false;

void main() {
  const RenderView view = frame.view;
  Splat splat;
  if (!loadSplat(view, kLarge, splat)) return;
  const float inverseRadiusSquared = 1 / (splat.disc.radius * splat.disc.radius);
  const float band = kDepthBand * splat.disc.radius;
  const float scale = args.counts.at[0].sumScale;
  // If many points make the unit coarse, at most the weight of a rim.
  const float leastWeight = min(kMinWeight / scale, kRimWeight);
  const bool hasColors = frame.hasColors != 0;
  const vec3 color = hasColors ? unpackUnorm4x8(shownColor(args.colors, splat.point)).rgb : vec3(0);
  const uint samples = view.size_px.x * view.size_px.y;
  for (; splat.pixel.y <= splat.box.last.y; goOn(splat)) {
    Fragment fragment;
    if (!coverPixel(view, splat.disc, inverseRadiusSquared, splat.pixel, fragment)) continue;
    const uint place = uint(splat.pixel.y) * view.size_px.x + uint(splat.pixel.x);
    if (fragment.depth > uintBitsToFloat(args.depth.at[place]) + band) continue;
    const float weight = max(fragment.weight, leastWeight);
    addNormal(args.normalSums, place, weight, splat.disc.shading, scale);
    if (hasColors) addColor(args.colorSums, place, samples, weight, color, scale);
  }
}
