#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
// What a window shows: a picture, and over it the triangles of its panels, blended from the lowest to the uppermost. A
// workgroup for each tile, an invocation for each pixel. A pixel belongs to a triangle if its middle does; a middle on
// the edge of two belongs to one of them.
#include "shaders/lib/index.glsl"
#include "shaders/shared/panels.h"

layout(push_constant, scalar) uniform Push { PanelArgs args; };

// Twice the area of the triangle that `p` makes with an edge, and whether the edge runs as it is computed. That is
// always in the same direction, so that two triangles see the same edge.
struct Side {
  float area;
  bool forward;
};
Side sideOf(vec2 a, vec2 b, vec2 p) {
  const bool forward = a.y < b.y || (a.y == b.y && a.x < b.x);
  const vec2 from = forward ? a : b, to = forward ? b : a;
  const vec2 edge = to - from, way = p - from;
  precise float area = edge.x * way.y - edge.y * way.x;
  return Side(forward ? area : -area, forward);
}

bool covers(Side side, bool anticlockwise) {
  if (side.area == 0) return side.forward == anticlockwise;
  return (side.area > 0) == anticlockwise;
}

float coverage(vec2 uv) {
  const uvec2 last = args.texture_px - 1u;
  const uvec2 texel = min(uvec2(max(uv, vec2(0)) * vec2(args.texture_px)), last);
  const uint place = texel.y * args.texture_px.x + texel.x;
  return float(args.texture.at[place / 4] >> 8 * (place % 4) & 0xffu) / 255;
}

// The triangle over what lies below it.
vec3 blended(vec3 below, PanelTriangle triangle, vec2 p) {
  const vec4 clip = args.clips.at[triangle.clip];
  if (any(lessThan(p, clip.xy)) || any(greaterThanEqual(p, clip.zw))) return below;
  const PanelVertex a = args.vertices.at[triangle.vertices.x], b = args.vertices.at[triangle.vertices.y],
                    c = args.vertices.at[triangle.vertices.z];
  const Side ab = sideOf(a.place_px, b.place_px, p), bc = sideOf(b.place_px, c.place_px, p),
             ca = sideOf(c.place_px, a.place_px, p);
  const float area = ab.area + bc.area + ca.area;
  if (area == 0) return below;
  const bool anticlockwise = area > 0;
  if (!covers(ab, anticlockwise) || !covers(bc, anticlockwise) || !covers(ca, anticlockwise)) return below;
  const vec3 share = vec3(bc.area, ca.area, ab.area) / area;
  const vec4 color =
      share.x * unpackUnorm4x8(a.color) + share.y * unpackUnorm4x8(b.color) + share.z * unpackUnorm4x8(c.color);
  const float alpha = color.a * coverage(share.x * a.uv + share.y * b.uv + share.z * c.uv);
  return mix(below, color.rgb, alpha);
}

void main() {
  const uvec2 tiles = (args.size_px + kPanelTile_px - 1u) / kPanelTile_px;
  const uint tile = workgroupIndex();
  if (tile >= tiles.x * tiles.y) return;
  const uvec2 inTile = uvec2(gl_LocalInvocationIndex % kPanelTile_px, gl_LocalInvocationIndex / kPanelTile_px);
  const uvec2 pixel = uvec2(tile % tiles.x, tile / tiles.x) * kPanelTile_px + inTile;
  if (any(greaterThanEqual(pixel, args.size_px))) return;
  const uint place = pixel.y * args.size_px.x + pixel.x;
  const bool hasPicture = uvec2(args.picture) != uvec2(0);
  const uvec2 seen = pixel / args.shrink;
  vec3 color = unpackUnorm4x8(args.background).rgb;
  if (hasPicture) color = unpackUnorm4x8(args.picture.at[seen.y * args.pictureWidth_px + seen.x]).rgb;
  const vec2 p = vec2(pixel) + 0.5;
  for (uint i = args.starts.at[tile]; i < args.starts.at[tile + 1]; ++i)
    color = blended(color, args.triangles.at[args.entries.at[i]], p);
  args.shown.at[place] = packUnorm4x8(vec4(args.blueFirst != 0 ? color.bgr : color, 1));
}
