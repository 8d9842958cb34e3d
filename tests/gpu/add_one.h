#ifndef PALPATE_TESTS_ADD_ONE_H
#define PALPATE_TESTS_ADD_ONE_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

struct AddOneArgs {
  PALPATE_ADDRESS(Uints) from;
  PALPATE_ADDRESS(Uints) to;
  uint count;
  uint unused;
};
PALPATE_SIZE(AddOneArgs, 24);

PALPATE_SHARED_END
#endif
