// A triangle of a mesh, and the samples that one invocation walks for it. Both triangle passes see exactly the same
// fragments through this file.
#ifndef PALPATE_RENDER_TRIANGLE_GLSL
#define PALPATE_RENDER_TRIANGLE_GLSL
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/view.glsl"

layout(push_constant, scalar) uniform Push { TriangleArgs args; };

struct Triangle {
  uvec3 vertices;
  vec3 corners[3];    // eye space
  vec2 corners_px[3];
  vec3 normal;        // of its plane, not unit; away from the eye if its outside is seen: eye space is left-handed
  ivec2 first, last;  // samples that its box holds, both included
  uvec2 tiles;        // of its box
};

// Twice the area of (a, b, p), the same up to its sign for (b, a, p), so that no sample falls between two triangles.
float edgeSide(vec2 a, vec2 b, bool turned, vec2 p) {
  const vec2 from = turned ? b : a, to = turned ? a : b;
  precise float area = (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x);
  return turned ? -area : area;
}

// False if there is nothing to draw.
bool loadTriangle(RenderView view, uint number, out Triangle t) {
  vec2 low = vec2(1e7), high = vec2(-1e7);
  for (uint k = 0; k < 3; ++k) {
    t.vertices[k] = args.triangles.at[3 * number + k];
    t.corners[k] = toEye(view, args.vertices.at[t.vertices[k]].position - view.eye);
    if (!(t.corners[k].z >= view.nearDepth)) return false;
    t.corners_px[k] = sampleOf(view, t.corners[k]);
    if (!all(lessThan(abs(t.corners_px[k] - view.center_px), vec2(1e6)))) return false;
    low = min(low, t.corners_px[k]);
    high = max(high, t.corners_px[k]);
  }
  t.normal = cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
  if (frame.hidesBacks != 0 && dot(t.normal, sightTo(view, t.corners[0])) < 0) return false;
  // Sample k has its middle at k + 0.5.
  t.first = max(ivec2(ceil(low - 0.5)), ivec2(0));
  t.last = min(ivec2(floor(high - 0.5)), ivec2(view.size_px) - 1);
  if (any(greaterThan(t.first, t.last))) return false;
  t.tiles = uvec2(t.last - t.first) / kTriangleTile + 1;
  return true;
}

struct Hit {
  float depth;
  vec3 shares;  // of the corners
};

// False if the ray through a sample misses the triangle.
bool hitAt(RenderView view, Triangle t, ivec2 sampleAt, out Hit hit) {
  const vec2 p = vec2(sampleAt) + 0.5;
  vec3 sides;
  for (uint k = 0; k < 3; ++k) {
    const uint a = (k + 1) % 3, b = (k + 2) % 3;
    sides[k] = edgeSide(t.corners_px[a], t.corners_px[b], t.vertices[a] > t.vertices[b], p);
  }
  const float area = sides.x + sides.y + sides.z;
  if (area == 0 || !(all(greaterThanEqual(sides, vec3(0))) || all(lessThanEqual(sides, vec3(0))))) return false;
  const vec3 depths = vec3(t.corners[0].z, t.corners[1].z, t.corners[2].z);
  const vec3 divisors = view.isOrthographic != 0 ? vec3(1) : depths;
  const vec3 perspective = sides / divisors;  // shares on screen are not those in space
  hit.shares = perspective / (perspective.x + perspective.y + perspective.z);
  hit.depth = dot(hit.shares, depths);
  return true;
}

#endif
