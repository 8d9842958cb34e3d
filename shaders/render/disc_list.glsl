#ifndef PALPATE_DISC_LIST_GLSL
#define PALPATE_DISC_LIST_GLSL
// The list of discs to be measured again. The including file declares the push constants as `args`, with `list` and
// `count`.
#extension GL_KHR_shader_subgroup_ballot : require

// Appends the slots of the invocations that want it; the whole subgroup calls it together.
void listDisc(bool wants, uint slot) {
  const uvec4 ballot = subgroupBallot(wants);
  const uint here = subgroupBallotBitCount(ballot);
  if (here == 0) return;
  uint first = 0;
  if (subgroupElect()) first = atomicAdd(args.count.at[0], here);
  first = subgroupBroadcastFirst(first);
  if (wants) args.list.at[first + subgroupBallotExclusiveBitCount(ballot)] = slot;
}

#endif
