#version 460
#extension GL_GOOGLE_include_directive : require
// Surface splatting in compute (Zwicker et al. 2001; two passes after Botsch and Kobbelt 2003), pass 3: the nearest
// depth of every sample. Bits of positive floats are ordered like the floats, so an integer minimum can be used.
#include "shaders/render/frame_block.glsl"
#include "shaders/render/splat.glsl"

layout(constant_id = 1) const bool kLarge = false;

void main() {
  const RenderView view = frame.view;
  Splat splat;
  if (!loadSplat(view, kLarge, splat)) return;
  const float inverseRadiusSquared = 1 / (splat.disc.radius * splat.disc.radius);
  for (; splat.pixel.y <= splat.box.last.y; goOn(splat)) {
    Fragment fragment;
    if (!coverPixel(view, splat.disc, inverseRadiusSquared, splat.pixel, fragment)) continue;
    const uint place = uint(splat.pixel.y) * view.size_px.x + uint(splat.pixel.x);
    const uint bits = floatBitsToUint(fragment.depth);
    // The plain read may be stale, but depths only fall, so it never skips the nearest.
    if (bits < args.depth.at[place]) atomicMin(args.depth.at[place], bits);
  }
}
