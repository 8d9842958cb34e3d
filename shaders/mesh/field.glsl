// The surface at any place, summed over the points that the hash has around it: that of contact
// (shaders/lib/surface_fit.glsl), or the skin where the density of the points (thesis, equation 3.1) falls to a given
// one. One invocation looks at one place.
#ifndef PALPATE_MESH_FIELD_GLSL
#define PALPATE_MESH_FIELD_GLSL

#include "shaders/mesh/lattice.glsl"
// After what names the buffers of contact.
#include "shaders/lib/surface_fit.glsl"
#include "shaders/lib/weight.glsl"

layout(constant_id = 1) const uint kMeshSurface = kSurfaceSphere;
layout(constant_id = 2) const bool kMeshColored = false;

struct FieldSums {
  SurfaceSums surface;
  vec3 slope;   // of the density, inwards, any length
  vec4 colors;  // sum of w c, sum of w
};

// Weights that let go of points across an edge (Oztireli, Guennebaud, Gross 2009).
float robust(Surface before, vec3 d, vec3 n) {
  const vec3 turn = (n - before.normal) / kSharpNormal;
  const float height = (-dot(d, n) - before.distance / args.lattice.radius) / kSharpHeight;
  return exp(-dot(turn, turn) - height * height);
}

void addPoint(inout FieldSums sums, uint slot, vec4 point, vec3 d, bool again, Surface before, bool colored) {
  const float r = length(d);
  const vec3 n = args.cloud.normals.at[slot].xyz;
  float w = wendland(r);
  if (again) w *= robust(before, d, n);
  if (w <= 0.0) return;
  sums.surface.offsets += w * vec4(d, 1.0);
  sums.surface.normals += vec4(w * n, 1.0);
  sums.surface.products += w * vec2(r * r, dot(d, n));
  sums.slope += (1.0 - r) * (1.0 - r) * (1.0 - r) * d;
  if (colored) sums.colors += w * vec4(unpackUnorm4x8(args.buffers.at[0].colors.at[floatBitsToUint(point.w)]).rgb, 1.0);
}

// All points within the support radius, in the order of the cells and then of the points.
FieldSums sumAround(vec3 x, bool again, Surface before, bool colored) {
  FieldSums sums = FieldSums(SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0)), vec3(0.0), vec4(0.0));
  const float radius = args.lattice.radius;
  const ivec3 low = cellOf(args.cloud.grid, x - radius);
  const ivec3 high = min(cellOf(args.cloud.grid, x + radius), low + 2);
  uint candidates = 0;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int cx = low.x; cx <= high.x; ++cx) {
        const uvec2 range = args.cloud.ranges.at[bucketOf(args.cloud.grid, ivec3(cx, y, z))];
        candidates += min(range.y - range.x, 1u << 24);
      }
  if (candidates == 0) return sums;
  const uint stride = 1 + (candidates - 1) / kMeshMostCandidates;
  uint skip = 0;  // candidates until the next one that is taken
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int cx = low.x; cx <= high.x; ++cx) {
        const ivec3 cell = ivec3(cx, y, z);
        const uvec2 range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cell)];
        uint slot = range.x + skip;
        for (; slot < range.y; slot += stride) {
          const vec4 point = args.cloud.positions.at[slot];
          const vec3 d = (point.xyz - x) / radius;
          // Another of these cells may share the bucket: its points are looked at as that one's.
          if (dot(d, d) >= 1.0 || cellOf(args.cloud.grid, point.xyz) != cell) continue;
          addPoint(sums, slot, point, d, again, before, colored);
        }
        skip = slot - range.y;
      }
  return sums;
}

struct FieldSample {
  bool defined;
  float value;  // negative inside, model units
  vec3 normal;  // unit, outwards; zero where there is none
  vec4 color;   // sum of the weights in a
};

FieldSample fieldAt(vec3 x, bool colored) {
  const Surface nothing = Surface(false, 0.0, vec3(0.0), 0);
  const uint passes = kMeshSurface == kSurfaceSharp ? kSharpPasses : 1;
  Surface surface = nothing;
  FieldSums sums;
  for (uint pass = 0; pass < passes; ++pass) {
    sums = sumAround(x, pass > 0, surface, colored);
    if (kMeshSurface == kSurfaceDensity) {
      const float density = sums.surface.offsets.w * args.lattice.densityScale;
      const float steep = length(sums.slope);
      const vec3 normal = steep > 0.0 ? -sums.slope / steep : vec3(0.0);
      return FieldSample(true, (kMeshIsoDensity - density) * args.lattice.radius, normal, sums.colors);
    }
    const Surface next = surfaceFrom(sums.surface, args.lattice.radius, kMeshSurface);
    if (!next.defined) break;
    surface = next;
  }
  return FieldSample(surface.defined, surface.distance, surface.normal, sums.colors);
}

#endif
