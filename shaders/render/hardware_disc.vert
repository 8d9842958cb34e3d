#version 460
#extension GL_GOOGLE_include_directive : require
// The discs of a cloud for the graphics pipeline: each a point sprite or a quad that covers the disc's box of pixels.
// A sprite costs one vertex and one primitive, but is square and no larger than the GPU allows.
#define HARDWARE_DISC out
#include "shaders/render/hardware_disc.glsl"

layout(constant_id = 0) const uint kQuads = 0;  // 0: each vertex is a point; else six of them are the two triangles of one

const uint kCorners[6] = uint[6](0, 1, 2, 2, 1, 3);

const float kDepthSlack = 1e-5;  // of the centre's depth: more than rounding takes from the depth of a fragment

out gl_PerVertex {
  vec4 gl_Position;
  float gl_PointSize;
};

void main() {
  const uint point = kQuads != 0 ? gl_VertexIndex / 6 : gl_VertexIndex;
  gl_Position = vec4(0, 0, 2, 1);  // out of sight
  gl_PointSize = 1;
  if (point >= args.count) return;
  const RenderView view = args.frame.at[0].view;
  Disc disc;
  if (!placeDisc(view, args.positions.at[point].xyz, disc)) return;
  orientDisc(view, args.normals.at[point], args.clips.at[point], args.frame.at[0].splatRadius, disc);
  const PixelBox box = boxOf(view, disc);
  if (any(greaterThan(box.first, box.last))) return;
  const ivec2 size = box.last - box.first + 1;
  const uint side = max(size.x, size.y);
  if ((side > args.largestPoint_px) != (kQuads != 0)) return;

  vec2 place_px = 0.5 * vec2(box.first + box.last + 1);
  const uint corner = kCorners[gl_VertexIndex % 6];
  if (kQuads != 0) place_px += (vec2(corner & 1, corner >> 1) - 0.5) * vec2(size);
  const float lead = args.lead * disc.radius;
  const float reach = disc.radius * sqrt(max(1 - disc.normal.z * disc.normal.z, 0));
  const float nearest = max(disc.center.z - reach, view.nearDepth) - kDepthSlack * disc.center.z - lead;
  gl_Position = vec4(2 * place_px / vec2(view.size_px) - 1, max(nearest, 0) * args.depthScale, 1);
  gl_PointSize = side;

  drawn.center = vec4(disc.center, 1 / (disc.radius * disc.radius));
  drawn.normal = vec4(disc.normal, lead);
  drawn.clip = vec4(disc.clip, disc.trust);
  drawn.shading = disc.shading;
  drawn.centerPixel = disc.centerPixel;
  drawn.color = args.frame.at[0].hasColors != 0 ? args.colors.at[point] : 0;
}
