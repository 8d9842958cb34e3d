// Water at a pixel of the picture.
#ifndef PALPATE_RENDER_WATER_GLSL
#define PALPATE_RENDER_WATER_GLSL
#include "shaders/lib/index.glsl"
#include "shaders/render/surfel.glsl"
#include "shaders/shared/water.h"

layout(push_constant, scalar) uniform Push { WaterArgs args; };

// The view with one sample for each pixel.
RenderView pictureView(RenderView view) {
  view.size_px = uvec2(pictureSize(view));
  view.center_px /= float(view.supersample);
  view.focal_px = pixelFocal(view);
  view.supersample = 1;
  return view;
}

// Radius of a ball in the picture, pixels.
float ballAt(RenderView view, float depth) {
  return max(args.radius * view.focal_px / divisorAt(view, depth), kMinBall_px);
}

#endif
