// Reads the frame for the passes of a fusion: field by field, since the validation layer of Debian 12 overestimates the
// size of the load of a whole struct.
#ifndef PALPATE_LIB_FUSION_BUFFERS_GLSL
#define PALPATE_LIB_FUSION_BUFFERS_GLSL
#include "shaders/shared/fusion_passes.h"

FusionView viewOf(FusionViews views) {
  FusionView view;
  view.right = views.at[0].right;
  view.down = views.at[0].down;
  view.ahead = views.at[0].ahead;
  view.centre = views.at[0].centre;
  view.sensor.camera.fx = views.at[0].sensor.camera.fx;
  view.sensor.camera.fy = views.at[0].sensor.camera.fy;
  view.sensor.camera.cx = views.at[0].sensor.camera.cx;
  view.sensor.camera.cy = views.at[0].sensor.camera.cy;
  view.sensor.noise.least = views.at[0].sensor.noise.least;
  view.sensor.noise.growth = views.at[0].sensor.noise.growth;
  view.sensor.noise.from = views.at[0].sensor.noise.from;
  view.memory = views.at[0].memory;
  view.width = views.at[0].width;
  view.height = views.at[0].height;
  view.number = views.at[0].number;
  view.colored = views.at[0].colored;
  view.felt = views.at[0].felt;
  view.left = views.at[0].left;
  view.perSecond = views.at[0].perSecond;
  return view;
}

PixelSurface surfaceAt(PixelSurfaces surfaces, uint pixel) {
  PixelSurface surface;
  surface.normal = surfaces.at[pixel].normal;
  surface.depth = surfaces.at[pixel].depth;
  return surface;
}

#endif
