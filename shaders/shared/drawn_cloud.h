#ifndef PALPATE_SHARED_DRAWN_CLOUD_H
#define PALPATE_SHARED_DRAWN_CLOUD_H
#include "shaders/shared/edit_log.h"

PALPATE_SHARED_BEGIN

// A range of the edit log on its way into the drawn cloud.
struct CatchUpArgs {
  PALPATE_ADDRESS(EditEntries) entries;  // the ring
  PALPATE_ADDRESS(Uints) latest;         // per point: 1 + the place in the range of its last entry; 0 between ranges
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;  // RGBA8; not written where `colored` is 0
  uint firstSlot;  // of the range in the ring
  uint slotMask;   // the ring has slotMask + 1 slots
  uint entryCount;
  uint pointCount;
  uint colored;
  uint unused;
};
PALPATE_SIZE(CatchUpArgs, 64);

PALPATE_SHARED_END
#endif
