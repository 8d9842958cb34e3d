// Where an invocation stands in a dispatch that may have needed two axes of workgroups (CommandList::dispatch).
#ifndef PALPATE_LIB_INDEX_GLSL
#define PALPATE_LIB_INDEX_GLSL

layout(local_size_x_id = 0) in;

uint workgroupIndex() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
uint threadIndex() { return workgroupIndex() * gl_WorkGroupSize.x + gl_LocalInvocationIndex; }

#endif
