// Index of an invocation in a dispatch that may need two axes of workgroups (CommandList::dispatch).
#ifndef PALPATE_LIB_INDEX_GLSL
#define PALPATE_LIB_INDEX_GLSL

layout(local_size_x_id = 0) in;

#ifdef PALPATE_WATCHED
// Lifetime of workgroups: that of their longest invocation (WorkgroupWatch).
#extension GL_EXT_shader_realtime_clock : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
layout(constant_id = 30) const uint kLifeLow = 0;  // address of a word
layout(constant_id = 31) const uint kLifeHigh = 0;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LongestLife { uint ticks; };
void watchedMain();
void main() {
  const uint begin = clockRealtime2x32EXT().x;
  watchedMain();
  const uint life = clockRealtime2x32EXT().x - begin;
  // Additions to one word by all subgroups of a GPU queue up, and would make lifetimes long by themselves. The plain
  // read may be stale, but the word only grows.
  LongestLife longest = LongestLife(uvec2(kLifeLow, kLifeHigh));
  if (life > longest.ticks) atomicMax(longest.ticks, life);
}
#define main watchedMain
#endif

uint workgroupIndex() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
uint threadIndex() { return workgroupIndex() * gl_WorkGroupSize.x + gl_LocalInvocationIndex; }

#endif
