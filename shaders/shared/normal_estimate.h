#ifndef PALPATE_SHARED_NORMAL_ESTIMATE_H
#define PALPATE_SHARED_NORMAL_ESTIMATE_H
#include "shaders/shared/contact.h"

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Vec2s { vec2 at[]; };
#endif

PALPATE_SHARED_BEGIN

// Bounds for the neighbours in a point's support radius: with fewer it is widened (at most kWidestEstimate times), with
// more narrowed, so that one radius serves an uneven cloud.
const uint kFewestEstimated = 8;
const uint kMaxEstimated = 200;
const uint kWantedEstimated = 50;  // an even surface holds them within kSupportSpacings
const float kWidestEstimate = 4.0f;
const uint kEstimatePasses = 5;
// A noisy region uses a wider radius; engine/cloud/normals.cpp documents when and why, in points where this file uses
// lengths.
const float kCleanEstimate = 0.005f;
const float kWiderEstimate = 2.0f;  // and every other point within it
const float kFlatterEstimate = 0.5f;
const float kLineLike = 1e-3f;  // variance across over variance along, below which neighbours lie on a line
// Next to an edge a plane cuts across it. engine/cloud/normals.cpp documents how an edge is recognised and what is
// done.
const float kEdgeFrom = 0.12f;
const float kEdgeSurely = 0.2f;
const float kEdgeOfNoise = 6.0f;
const float kOwnFlatness = 0.06f;
const float kOwnFlatnessOfNoise = 0.5f;
const float kOwnHeight = 0.08f;
const float kOwnHeightOfNoise = 3.0f;
const float kSameFace = 0.9f;  // cosine between normals of one face
const float kMinEdgeWeight =
    1e-6f;  // minimum for the neighbour with the largest weight for a face; below it the normal stays
// Loop iterations of one point in one pass; beyond this the point is left to the host, which happens only if buckets
// are crowded. Small, since a validated shader searches every buffer in each iteration, and one software driver stops a
// shader after 65,535.
const uint kEstimateWorkBudget = 1024;
const uint kEdgeWorkBudget = 512;  // for each of three walks, which read more per iteration

// Of each point, the nearest neighbour in each of kGraphSectors sectors of its plane: a graph that is connected where
// the points are (Yao 1982), with few edges.
const uint kGraphSectors = 8;
const uint kEnoughSectors = 6;  // with a neighbour within half the support radius; with fewer, all of it is searched
const uint kNoNeighbour = 0xffffffffu;

struct NormalEstimateArgs {
  CloudView cloud;
  PALPATE_ADDRESS(Vec4s)
  planes;  // by the point's id: unit normal of either sign, w the radius used; zero: left to the host
  PALPATE_ADDRESS(Vec2s) fits;        // by id: variance of the neighbours off the plane, and the local spacing squared
  PALPATE_ADDRESS(Vec4s) normals;     // out, by id: that of the plane, or next to an edge that of the point's own face
  PALPATE_ADDRESS(Uints) neighbours;  // out, kGraphSectors ids for each id; kNoNeighbour for an empty sector
  float radius;                       // support radius, model units
  uint unused;
};
PALPATE_SIZE(NormalEstimateArgs, 96);

PALPATE_SHARED_END
#endif
