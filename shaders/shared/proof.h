#ifndef PALPATE_SHARED_PROOF_H
#define PALPATE_SHARED_PROOF_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// What proof/primitives.comp does, by its first specialisation constant.
const uint kProofSum = 0, kProofBallot = 1, kProofShuffle = 2, kProofBarrier = 3, kProofAtomic = 4, kProofHostWrite = 5,
           kProofCount = 6, kProofCounted = 7, kProofSpoil = 8;

const uint kProofWorkgroup = 256;
const uint kProofWords = 4;    // that an invocation writes
const uint kProofRounds = 6;   // of values that invocations pass on to each other
const uint kProofStride = 75;  // from one to the next: into another subgroup

struct ProofArgs {
  PALPATE_ADDRESS(Uints) values;    // one for each invocation
  PALPATE_ADDRESS(Uints) results;   // kProofWords for each
  PALPATE_ADDRESS(Uints) counters;  // 0 at first, but the minimum, number 1, which is all ones
  PALPATE_ADDRESS(Uints) others;    // as many words as values
};
PALPATE_SIZE(ProofArgs, 32);

PALPATE_SHARED_END

#endif
