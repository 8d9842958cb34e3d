#version 460
#extension GL_GOOGLE_include_directive : require
// The discs of a cloud for the graphics pipeline: a point sprite over the disc's box of pixels, or a square of sprites
// if the GPU's maximum point size is too small for the largest disc.
#define HARDWARE_DISC out
#include "shaders/render/frame_block.glsl"
#include "shaders/render/hardware_disc.glsl"
#include "shaders/render/shown.glsl"

const float kDepthSlack = 1e-5;  // of the centre's depth: more than the rounding error of a fragment's depth

out gl_PerVertex {
  vec4 gl_Position;
  float gl_PointSize;
};

void main() {
  gl_Position = vec4(0, 0, 2, 1);  // outside the view
  gl_PointSize = 1;
  const uint shares = args.tiles * args.tiles;
  const uint point = gl_VertexIndex / shares;
  if (point >= args.count || !isDisc(point)) return;
  const RenderView view = frame.view;
  Disc disc;
  if (!placeDisc(view, args.positions.at[point].xyz, disc)) return;
  if (!orientDisc(view, args.normals.at[point], args.clips.at[point], frame.splatRadius,
                  frame.hidesBacks, disc))
    return;
  PixelBox box = boxOf(view, disc);
  const uint share = gl_VertexIndex % shares;
  box.first += ivec2(share % args.tiles, share / args.tiles) * int(args.largestPoint_px);
  box.last = min(box.last, box.first + int(args.largestPoint_px) - 1);
  if (any(greaterThan(box.first, box.last))) return;
  const ivec2 size = box.last - box.first + 1;
  const vec2 place_px = 0.5 * vec2(box.first + box.last + 1);
  const float lead = args.lead * disc.radius;
  const float reach = disc.radius * sqrt(max(1 - disc.normal.z * disc.normal.z, 0));
  const float nearest = max(disc.center.z - reach, view.nearDepth) - kDepthSlack * disc.center.z - lead;
  gl_Position = vec4(2 * place_px / vec2(view.size_px) - 1, max(nearest, 0) * args.depthScale, 1);
  gl_PointSize = max(size.x, size.y);

  drawn.center = vec4(disc.center, 1 / (disc.radius * disc.radius));
  drawn.normal = vec4(disc.normal, lead);
  drawn.clip = vec4(disc.clip, disc.trust);
  drawn.shading = disc.shading;
  drawn.centerPixel = disc.centerPixel;
  drawn.box = ivec4(box.first, box.last);
  drawn.color = frame.hasColors != 0 ? shownColor(args.colors, point) : 0;
}
