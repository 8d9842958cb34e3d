#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
// The layer over a window's picture: the triangles of its panels, blended from the lowest to the topmost. One workgroup
// for each tile to draw, one invocation for each pixel. A pixel belongs to a triangle if its middle does; a middle on
// the edge between two belongs to one of them.
#include "shaders/lib/index.glsl"
#include "shaders/lib/subgroup_reduce.glsl"
#include "shaders/shared/panels.h"

layout(push_constant, scalar) uniform Push { PanelLayerArgs args; };

// Twice the area of the triangle of `p` and an edge, and whether the edge has the direction in which it is computed.
// That is always the same, so that two triangles use the same edge.
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

// A triangle as one invocation reads it for its subgroup: on a software driver reads cost far more than shuffles.
struct Shape {
  vec4 clip;
  PanelVertex a, b, c;
};
Shape readShape(uint entry) {
  const PanelTriangle triangle = args.triangles.at[args.entries.at[entry]];
  return Shape(args.clips.at[triangle.clip], args.vertices.at[triangle.vertices.x],
               args.vertices.at[triangle.vertices.y], args.vertices.at[triangle.vertices.z]);
}
PanelVertex vertexOf(PanelVertex vertex, uint invocation) {
  return PanelVertex(subgroupShuffle(vertex.place_px, invocation), subgroupShuffle(vertex.uv, invocation),
                     subgroupShuffle(vertex.color, invocation));
}
Shape shapeOf(Shape shape, uint invocation) {
  return Shape(subgroupShuffle(shape.clip, invocation), vertexOf(shape.a, invocation), vertexOf(shape.b, invocation),
               vertexOf(shape.c, invocation));
}

// Whether the triangle may cover a pixel between two corners.
bool mayShow(Shape shape, vec2 low, vec2 high) {
  const vec2 least = min(min(shape.a.place_px, shape.b.place_px), shape.c.place_px);
  const vec2 most = max(max(shape.a.place_px, shape.b.place_px), shape.c.place_px);
  return all(lessThanEqual(max(least, shape.clip.xy), high)) && all(greaterThanEqual(min(most, shape.clip.zw), low));
}

// The triangle blended over what is below: premultiplied, with the share of light that passes in w.
vec4 blended(vec4 below, Shape shape, vec2 p) {
  if (any(lessThan(p, shape.clip.xy)) || any(greaterThanEqual(p, shape.clip.zw))) return below;
  const PanelVertex a = shape.a, b = shape.b, c = shape.c;
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
  return mix(below, vec4(color.rgb, 0), alpha);
}

void main() {
  if (workgroupIndex() >= args.tileCount) return;
  const uint tile = args.tiles.at[workgroupIndex()], columns = (args.size_px.x + kPanelTile_px - 1) / kPanelTile_px;
  const uvec2 inTile = uvec2(gl_LocalInvocationIndex % kPanelTile_px, gl_LocalInvocationIndex / kPanelTile_px);
  const uvec2 pixel = uvec2(tile % columns, tile / columns) * kPanelTile_px + inTile;
  const vec2 p = vec2(pixel) + 0.5, low = reduceMin(p), high = reduceMax(p);
  const uint end = args.starts.at[tile + 1];
  vec4 color = vec4(0, 0, 0, 1);
  for (uint first = args.starts.at[tile]; first < end; first += gl_SubgroupSize) {
    const uint entry = first + gl_SubgroupInvocationID;
    Shape own;
    bool shows = entry < end;
    if (shows) {
      own = readShape(entry);
      shows = mayShow(own, low, high);
    }
    for (uvec4 left = subgroupBallot(shows); left != uvec4(0);) {
      const uint next = subgroupBallotFindLSB(left);
      left[next / 32] &= left[next / 32] - 1;
      color = blended(color, shapeOf(own, next), p);
    }
  }
  if (all(lessThan(pixel, args.size_px)))
    args.layer.at[pixel.y * args.size_px.x + pixel.x] = uvec2(packUnorm2x16(color.rg), packUnorm2x16(color.ba));
}
