// Where the invocations of a subgroup meet, after a memory barrier. Each of its subgroups may be elsewhere, which
// subgroupBarrier() permits; but Mesa's software driver of 2025 takes that for a barrier of the whole workgroup, and
// then results are wrong. Its subgroups run in lockstep.
#ifndef PALPATE_LIB_SUBGROUP_MEET_GLSL
#define PALPATE_LIB_SUBGROUP_MEET_GLSL

#extension GL_KHR_shader_subgroup_basic : require

// Not 0: so it is with this driver (engine/gpu/pipeline_store.cpp).
layout(constant_id = 29) const uint kLockstep = 0;

void subgroupMeet() {
  if (kLockstep == 0) subgroupBarrier();
}

#endif
