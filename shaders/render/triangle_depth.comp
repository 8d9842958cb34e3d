#version 460
#extension GL_GOOGLE_include_directive : require
// A mesh in compute, pass 1: the nearest depth of every sample.
#include "shaders/render/frame_block.glsl"
#include "shaders/render/triangle.glsl"

void main() {
  const RenderView view = frame.view;
  const uint sharers = frame.triangleTiles * frame.triangleTiles;
  const uint number = threadIndex() / sharers;
  Triangle t;
  if (number >= frame.count || !loadTriangle(view, number, t)) return;
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
