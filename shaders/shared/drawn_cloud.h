#ifndef PALPATE_SHARED_DRAWN_CLOUD_H
#define PALPATE_SHARED_DRAWN_CLOUD_H
#include "shaders/shared/edit_log.h"
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// A range of the edit log that is applied to the drawn cloud.
struct CatchUpArgs {
  PALPATE_ADDRESS(EditEntries) entries;  // the ring
  PALPATE_ADDRESS(Uints) latest;         // per point: 1 + index in the range of its last entry; 0 between ranges
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;  // RGBA8; not written where `colored` is 0
  uint firstSlot;                 // of the range in the ring
  uint slotMask;                  // the ring has slotMask + 1 slots
  uint entryCount;
  uint pointCount;
  uint colored;
  uint marks;                      // not 0: marks buckets in which a point was added, removed, moved or rotated
  PALPATE_ADDRESS(Uints) changed;  // a bit for each bucket
  HashGrid grid;
  PALPATE_ADDRESS(Uints) end;  // one word: one past the last point that was ever there
};
PALPATE_SIZE(CatchUpArgs, 104);

// A disc is measured again if its point moves by more than this many mean spacings, or the end of its normal by more
// than this: frames of a camera move all visible points by part of their noise, and discs overlap by far more.
const float kKeepsDiscWithin = 0.05f, kKeepsDiscTurned = 0.1f;

// All points of a live cloud, to be copied into the drawn cloud.
struct PlaceArgs {
  PALPATE_ADDRESS(Vec4s) livePositions;
  PALPATE_ADDRESS(Vec4s) liveNormals;
  PALPATE_ADDRESS(Uints) latest;  // per point: 1 if it is in the live cloud; 0 between calls
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;  // RGBA8
  PALPATE_ADDRESS(Vec4s)
  measured;  // per point: position at which its disc was measured, and packSnorm4x8 of its normal there
  uint slots;
  uint pointCount;
  uint colored;  // not 0: the live normals carry colours (frameColor())
  uint marks;    // as in CatchUpArgs; 0: `measured` does not exist
  PALPATE_ADDRESS(Uints) changed;
  HashGrid grid;
  float keepsWithin;  // model units
  uint unused;
};
PALPATE_SIZE(PlaceArgs, 112);

// The colour of a point of a frame, opaque, from the bits next to its normal in the live cloud: red in the lowest byte.
// The highest byte is 0 there, so that the bits are not those of a NaN.
PALPATE_FUNCTION uint frameColor(uint bits) { return bits | 0xff000000u; }

PALPATE_SHARED_END
#endif
