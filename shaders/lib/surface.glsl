// The implicit surface that the points define around a place (Leeper, Chan, Salisbury 2012; Adamson and Alexa 2003):
// weighted average position a and normal n, signed distance f(x) = n . (x - a).
#ifndef PALPATE_LIB_SURFACE_GLSL
#define PALPATE_LIB_SURFACE_GLSL

#include "shaders/lib/patch.glsl"
#include "shaders/lib/weight.glsl"

struct Surface {
  bool defined;
  float distance;  // signed, model units, positive outside
  vec3 normal;     // unit
  uint neighbours;
};

shared vec4 partialOffsets[kMaxSubgroups];  // sum of w (p - x), sum of w
shared vec4 partialNormals[kMaxSubgroups];  // sum of w n, neighbours

// The surface at `x`, relative to the patch's centre. All invocations call it together and get the same answer.
Surface surfaceAt(SpilledPoints spill, vec3 x, float radius) {
  vec4 offsets = vec4(0.0);
  vec4 normals = vec4(0.0);
  for (uint i = scanIndex(); i < patchCount; i += kContactWorkgroup) {
    const vec3 d = patchPosition(spill, i) - x;
    const float squared = dot(d, d);
    if (squared < radius * radius) {
      const float w = wendland(sqrt(squared) / radius);
      offsets += w * vec4(d, 1.0);
      normals += vec4(w * patchNormal(spill, i), 1.0);
    }
  }
  workDone += patchCount / kContactWorkgroup + 1;

  offsets = subgroupAdd(offsets);
  normals = subgroupAdd(normals);
  barrier();
  if (subgroupElect()) {
    partialOffsets[gl_SubgroupID] = offsets;
    partialNormals[gl_SubgroupID] = normals;
  }
  barrier();
  offsets = vec4(0.0);
  normals = vec4(0.0);
  for (uint s = 0; s < gl_NumSubgroups; ++s) {
    offsets += partialOffsets[s];
    normals += partialNormals[s];
  }
  workDone += gl_NumSubgroups;

  Surface surface;
  surface.neighbours = uint(normals.w);
  const float normalLength = length(normals.xyz);
  surface.defined = surface.neighbours >= kMinNeighbours && normalLength > kLeastNormal * offsets.w && offsets.w > 0.0;
  surface.normal = surface.defined ? normals.xyz / normalLength : vec3(0.0);
  surface.distance = surface.defined ? -dot(surface.normal, offsets.xyz) / offsets.w : 0.0;
  return surface;
}

#endif
