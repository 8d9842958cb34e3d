#version 460
#extension GL_GOOGLE_include_directive : require
// The surface that each pixel of a depth frame sees. engine/motion/fusion.cpp does the same on the host.
#include "shaders/lib/index.glsl"
#include "shaders/lib/fusion_buffers.glsl"

layout(push_constant, scalar) uniform Push { PixelSurfaceArgs args; };

void main() {
  const uint pixel = threadIndex();
  if (pixel >= args.pixels) return;
  args.covered.at[pixel] = 0;
  const FusionView view = viewOf(args.view);
  const int width = int(view.width);
  const int column = int(pixel) % width, row = int(pixel) / width;
  const float middle = args.depths.at[pixel];
  PixelSurface surface;
  surface.normal = vec3(0);
  surface.depth = 0;
  if (middle > 0) {
    const int reach = fitReach(view.sensor, middle);
    const ivec2 first = max(ivec2(column, row) - reach, ivec2(0));
    const ivec2 last = min(ivec2(column, row) + reach, ivec2(width, int(view.height)) - 1);
    PlaneSums sums = noPixels(0.0);
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x)
        addPixel(sums, view.sensor, middle, vec2(float(x - column), float(y - row)),
                 args.depths.at[y * width + x]);
    surface = surfaceOf(sums, view.sensor, vec2(float(column), float(row)), middle);
  }
  args.surfaces.at[pixel].normal = surface.normal;
  args.surfaces.at[pixel].depth = surface.depth;
}
