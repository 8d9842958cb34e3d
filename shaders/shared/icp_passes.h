// What the passes of an ICP on the GPU read and write (engine/motion/pose_search_pass.hpp).
#ifndef PALPATE_SHARED_ICP_PASSES_H
#define PALPATE_SHARED_ICP_PASSES_H
#include "shaders/shared/fusion_passes.h"
#include "shaders/shared/icp.h"

PALPATE_SHARED_BEGIN

// Sums over pairs, in this order: the upper triangle of the matrix row by row, the right side, and the sums named here.
const uint kIcpUnknowns = 6u;
const uint kIcpRightSide = 21u;
const uint kIcpWeights = 27u;
const uint kIcpSquares = 28u;
const uint kIcpFeigned = 29u;
const uint kIcpSeen = 30u;
const uint kIcpPairs = 31u;
const uint kIcpSums = 32u;
// A workgroup sums up kIcpPixels pixels per invocation: in a fixed order, so that results are reproducible.
const uint kIcpWorkgroup = 64u;
const uint kIcpPixels = 8u;

// A query for pairs, in the map.
struct IcpView {
  vec3 right;  // axes of the camera, unit
  vec3 down;
  vec3 ahead;
  vec3 centre;
  vec3 pivot;
  float scale;
  float gate;
};
PALPATE_SIZE(IcpView, 68);

PALPATE_SHARED_END

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer IcpViews { IcpView at[]; };
#endif

PALPATE_SHARED_BEGIN

// Rounds of finding the points in front: nearest depths, then the lowest ids at those depths, then these points.
const uint kFrontDepths = 0u;
const uint kFrontIds = 1u;
const uint kFrontPoints = 2u;

struct MapFrontArgs {
  PALPATE_ADDRESS(FusionViews) view;
  PALPATE_ADDRESS(Vec4s) positions;  // by slot
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(SurfelRecords) records;  // by id
  PALPATE_ADDRESS(Uints) nearest;          // by pixel: bits of the depth
  PALPATE_ADDRESS(Uints) ids;              // kEmptySlot if there is no point
  PALPATE_ADDRESS(Vec4s) frontPlaces;      // xyz, w: the weight of its measurements
  PALPATE_ADDRESS(Vec4s) frontNormals;
  uint slots;
  uint turn;  // kFront...
};
PALPATE_SIZE(MapFrontArgs, 72);

struct IcpSumsArgs {
  PALPATE_ADDRESS(FusionViews) view;
  PALPATE_ADDRESS(IcpViews) query;
  PALPATE_ADDRESS(Depths) depths;
  PALPATE_ADDRESS(PixelSurfaces) surfaces;
  PALPATE_ADDRESS(Uints) ids;
  PALPATE_ADDRESS(Vec4s) frontPlaces;
  PALPATE_ADDRESS(Vec4s) frontNormals;
  PALPATE_ADDRESS(Depths) sums;  // out: kIcpSums for each workgroup
  uint stride;                   // every stride-th pixel, along rows and columns
  uint groups;
};
PALPATE_SIZE(IcpSumsArgs, 72);

PALPATE_SHARED_END
#endif
