// The fragment of a disc that a fragment shader processes.
#ifndef PALPATE_RENDER_HARDWARE_FRAGMENT_GLSL
#define PALPATE_RENDER_HARDWARE_FRAGMENT_GLSL
#define HARDWARE_DISC in
#include "shaders/render/hardware_disc.glsl"

// The vertex shader's depth is nearer than that of any fragment: hidden fragments are rejected before they are shaded.
layout(depth_greater) out float gl_FragDepth;

// Discards fragments that the disc does not cover, and sets the depth that is tested.
Fragment fragmentHere() {
  Disc disc;
  disc.center = drawn.center.xyz;
  disc.normal = drawn.normal.xyz;
  disc.clip = drawn.clip.xyz;
  disc.trust = drawn.clip.w;
  disc.centerPixel = drawn.centerPixel;
  RenderView view;  // the fields that coverPixel() needs
  view.center_px = args.center_px;
  view.focal_px = args.focal_px;
  view.nearDepth = args.nearDepth;
  view.isOrthographic = 0;
  const ivec2 pixel = ivec2(gl_FragCoord.xy);
  Fragment fragment;
  if (args.tiles > 1 && (any(lessThan(pixel, drawn.box.xy)) || any(greaterThan(pixel, drawn.box.zw)))) discard;
  if (!coverPixel(view, disc, drawn.center.w, pixel, fragment)) discard;
  gl_FragDepth = max(fragment.depth - drawn.normal.w, 0) * args.depthScale;
  fragment.weight = max(fragment.weight, args.leastWeight);
  return fragment;
}

#endif
