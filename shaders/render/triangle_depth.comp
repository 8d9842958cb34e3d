#version 460
#extension GL_GOOGLE_include_directive : require
// A mesh in compute, pass 1: the nearest depth of every sample.
#include "shaders/render/triangle.glsl"

void main() {
  const RenderView view = args.frame.at[0].view;
  const uint sharers = args.frame.at[0].triangleTiles * args.frame.at[0].triangleTiles;
  const uint number = threadIndex() / sharers;
  Triangle t;
  if (number >= args.frame.at[0].count || !loadTriangle(view, number, t)) return;
  for (uint tile = threadIndex() % sharers; tile < t.tiles.x * t.tiles.y; tile += sharers) {
    const ivec2 first = t.first + ivec2(tile % t.tiles.x, tile / t.tiles.x) * int(kTriangleTile);
    const ivec2 last = min(t.last, first + int(kTriangleTile) - 1);
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        Hit hit;
        if (!hitAt(view, t, ivec2(x, y), hit)) continue;
        const uint place = uint(y) * view.size_px.x + uint(x);
        const uint bits = floatBitsToUint(hit.depth);
        // The plain read may be stale, but depths only fall, so it never skips the nearest.
        if (bits < args.depth.at[place]) atomicMin(args.depth.at[place], bits);
      }
  }
}
