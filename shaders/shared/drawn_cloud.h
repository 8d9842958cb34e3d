#ifndef PALPATE_SHARED_DRAWN_CLOUD_H
#define PALPATE_SHARED_DRAWN_CLOUD_H
#include "shaders/shared/edit_log.h"
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// A range of the edit log on its way into the drawn cloud.
struct CatchUpArgs {
  PALPATE_ADDRESS(EditEntries) entries;  // the ring
  PALPATE_ADDRESS(Uints) latest;         // per point: 1 + the place in the range of its last entry; 0 between ranges
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;  // RGBA8; not written where `colored` is 0
  uint firstSlot;                 // of the range in the ring
  uint slotMask;                  // the ring has slotMask + 1 slots
  uint entryCount;
  uint pointCount;
  uint colored;
  uint marks;                      // not 0: buckets are marked that a point has left or come to, or where it has turned
  PALPATE_ADDRESS(Uints) changed;  // a bit for each bucket
  HashGrid grid;
};
PALPATE_SIZE(CatchUpArgs, 96);

// A disc is measured again where its point has moved by more than this many mean spacings, or its normal's end by more
// than this: frames of a camera move all that they see by some of their noise, and discs overlap by far more.
const float kKeepsDiscWithin = 0.05f, kKeepsDiscTurned = 0.1f;

// All points of a live cloud on their way into the drawn cloud.
struct PlaceArgs {
  PALPATE_ADDRESS(Vec4s) livePositions;
  PALPATE_ADDRESS(Vec4s) liveNormals;
  PALPATE_ADDRESS(Uints) latest;  // per point: 1 where it is among those of the live cloud; 0 between calls
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;    // RGBA8
  PALPATE_ADDRESS(Vec4s) measured;  // per point: where its disc was measured, and packSnorm4x8 of its normal there
  uint slots;
  uint pointCount;
  uint colored;  // not 0: the live normals carry colours (frameColor())
  uint marks;    // as in CatchUpArgs; 0: there is no `measured`
  PALPATE_ADDRESS(Uints) changed;
  HashGrid grid;
  float keepsWithin;  // model units
  uint unused;
};
PALPATE_SIZE(PlaceArgs, 112);

// The colour of a point of a frame, opaque, from the bits beside its normal in the live cloud: red in the lowest byte.
// The highest one stays 0 there, so that the bits are those of no NaN.
PALPATE_FUNCTION uint frameColor(uint bits) { return bits | 0xff000000u; }

PALPATE_SHARED_END
#endif
