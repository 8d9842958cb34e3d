#version 460
#extension GL_GOOGLE_include_directive : require
// A mesh in compute, pass 2: the nearest triangle of a sample, or the few that meet there, add their normals and
// colours. Sums are integers, so that their order does not matter.
#include "shaders/render/frame_block.glsl"
#include "shaders/render/shown.glsl"
#include "shaders/render/sums.glsl"
#include "shaders/render/triangle.glsl"

const float kSameDepth = 1 + 1e-6;  // two passes may round differently

// Unit, model axes. For an open surface seen from behind it is reversed towards the eye; a normal that faces away just
// behind an outline is lit as if it were the outline.
vec3 shadingNormal(RenderView view, Triangle t, Hit hit, vec3 toViewer) {
  vec3 normal = vec3(0);
  for (uint k = 0; k < 3; ++k) normal += hit.shares[k] * args.vertices.at[t.vertices[k]].normal;
  normal = toEye(view, normal);
  if (dot(t.normal, sightTo(view, t.corners[0])) < 0) normal = -normal;
  const float facing = dot(normal, toViewer);
  if (facing < 0) normal -= facing * toViewer;
  const float size = length(normal);
  return fromEye(view, size > 0 ? normal / size : toViewer);
}

void main() {
  const RenderView view = frame.view;
  const uint sharers = frame.triangleTiles * frame.triangleTiles;
  const uint number = threadIndex() / sharers;
  Triangle t;
  if (number >= frame.count || !loadTriangle(view, number, t)) return;
  const float scale = frame.sumScale;
  const bool hasColors = frame.hasColors != 0;
  for (uint tile = threadIndex() % sharers; tile < t.tiles.x * t.tiles.y; tile += sharers) {
    const ivec2 first = t.first + ivec2(tile % t.tiles.x, tile / t.tiles.x) * int(kTriangleTile);
    const ivec2 last = min(t.last, first + int(kTriangleTile) - 1);
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        Hit hit;
        if (!hitAt(view, t, ivec2(x, y), hit)) continue;
        const uint place = uint(y) * view.size_px.x + uint(x);
        if (hit.depth > uintBitsToFloat(args.depth.at[place]) * kSameDepth) continue;
        const vec3 normal = shadingNormal(view, t, hit, -normalize(rayThrough(view, vec2(x, y) + 0.5)));
        addNormal(args.normalSums, place, 1, clamp(normal, vec3(-1), vec3(1)), scale);
        if (!hasColors) continue;
        vec3 color = vec3(0);
        for (uint k = 0; k < 3; ++k)
          color += hit.shares[k] * unpackUnorm4x8(paintOf(args.vertices.at[t.vertices[k]].color)).rgb;
        addColor(args.colorSums, place, view.size_px.x * view.size_px.y, 1, color, scale);
      }
  }
}
