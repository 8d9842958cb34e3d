// Sums of fragments in a sample: of normals and colours, each times its weight, and of the weights.
//
// Sums are integers, so their value does not depend on the order of the additions. The fixed-point unit is 2^31 divided
// by the maximum number of drawn discs: even if all of them were in one sample with full weight, no sum could overflow.
// With so many discs the rounding errors average out; with few points in a sample the unit is fine enough. Normals are
// stored as n + 1, which is never negative, so that two sums may share a word of 64 bits without a carry between them:
// atomics of that width need half as many additions, and leave the same bytes.
#ifndef PALPATE_RENDER_SUMS_GLSL
#define PALPATE_RENDER_SUMS_GLSL
#ifdef PALPATE_WIDE_SUMS
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "shaders/shared/types.h"

#ifdef PALPATE_WIDE_SUMS
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer WideUints { uint64_t at[]; };

void addPair(Uints sums, uint first, uvec2 pair) {
  atomicAdd(WideUints(uint64_t(sums)).at[first / 2], packUint2x32(pair));
}
#else
void addPair(Uints sums, uint first, uvec2 pair) {
  atomicAdd(sums.at[first], pair.x);
  atomicAdd(sums.at[first + 1], pair.y);
}
#endif

// `normal`: no component exceeds 1.
void addNormal(Uints sums, uint place, float weight, vec3 normal, float scale) {
  const uvec4 fixedPoint = uvec4(round(scale * weight * vec4(normal + 1, 1)));
  addPair(sums, 4 * place, fixedPoint.xy);
  addPair(sums, 4 * place + 2, fixedPoint.zw);
}
// `sum`: of weight times normal, and of weights.
void storeNormal(Uints sums, uint place, vec4 sum, float scale) {
  const uvec4 fixedPoint = uvec4(round(scale * max(vec4(sum.xyz + sum.w, sum.w), vec4(0))));
  for (uint k = 0; k < 4; ++k) sums.at[4 * place + k] = fixedPoint[k];
}
float weightAt(Uints sums, uint place) { return float(sums.at[4 * place + 3]); }
// Not unit.
vec3 normalAt(Uints sums, uint place) {
  const uint weight = sums.at[4 * place + 3];
  return vec3(int(sums.at[4 * place] - weight), int(sums.at[4 * place + 1] - weight),
              int(sums.at[4 * place + 2] - weight));
}

// Red and green of all samples come first and blue after them, so that pairs are aligned.
void addColor(Uints sums, uint place, uint samples, float weight, vec3 color, float scale) {
  const uvec3 fixedPoint = uvec3(round(scale * weight * color));
  addPair(sums, 2 * place, fixedPoint.xy);
  atomicAdd(sums.at[2 * samples + place], fixedPoint.z);
}
void storeColor(Uints sums, uint place, uint samples, vec3 sum, float scale) {
  const uvec3 fixedPoint = uvec3(round(scale * sum));
  sums.at[2 * place] = fixedPoint.x;
  sums.at[2 * place + 1] = fixedPoint.y;
  sums.at[2 * samples + place] = fixedPoint.z;
}
vec3 colorAt(Uints sums, uint place, uint samples) {
  return vec3(sums.at[2 * place], sums.at[2 * place + 1], sums.at[2 * samples + place]);
}

#endif
