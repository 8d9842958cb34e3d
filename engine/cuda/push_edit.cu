#include "engine/cuda/push_edit.hpp"

#include <array>

#include "engine/cuda/gather_plan.cuh"
#include "shaders/shared/carried_normal.h"
#include "shaders/shared/look_ahead.h"
#include "shaders/shared/plane_fit.h"

namespace palpate::cu {

namespace {

constexpr unsigned kBlock = 256;

using Sums = PushEdit::Sums;
using Tables = PushEdit::Tables;

unsigned blocksFor(std::uint32_t threads) { return threads / kBlock + (threads % kBlock != 0); }

__device__ bool isActedOn(const PlacedTool& placed, const FoundPoint& found) {
  const uint cell = connectedCell(placed.tool, found);
  return (placed.connected[cell / 32] >> cell % 32 & 1) != 0;
}

__global__ void __launch_bounds__(kBlock)
    pushPoints(float4* positions, float4* normals, const __grid_constant__ Tables tables, uint count) {
  const uint i = blockIdx.x * kBlock + threadIdx.x;
  const Brush& brush = tables.brush;
  const BrushTool tool = tables.tool->tool;
  Sums* const sums = tables.sums;
  if (i >= count || tool.acts == 0) return;
  const float4 point = positions[i];
  const vec3 from = xyz(point), away = from - tool.middle;
  if (glm::dot(away, away) >= tool.reach * tool.reach) return;
  const uint id = __float_as_uint(point.w);
  Found& known = tables.founds[id];
  FoundPoint found{from, xyz(normals[i]), kFirstStep * brush.support, 0.0f};
  if (known.stroke == tool.stroke) found = {known.position, known.normal, known.room, 0.0f};
  if (mayBlock(brush, found)) tables.blockedIn[id] = sums->edits + 1;
  if (isSampled(id, tool.sampling)) {
    const MeasuredPoint share = measured(brush, tool, found);
    if (share.weight != 0 && isActedOn(*tables.tool, found)) {
      atomicAdd(&sums->weights, uint(share.weight));
      for (int k = 0; k < 3; ++k) atomicAdd(&sums->normals[k], uint(share.normal[k]));
      atomicAdd(&sums->heights, uint(share.height));
    }
    const uint near = entered(brush, tool, from, found);
    if (near != kOutsideSheet) {
      atomicOr(&sums->seen[near % kSheetCells / 32], 1u << near % 32);
      atomicMin(&sums->nearest, near);
    }
  }
  const vec3 to = brushed(brush, tool, from, found.normal, found).position;
  if (to == from || !isActedOn(*tables.tool, found)) return;
  known = {found.position, tool.stroke, found.normal, found.room};
  positions[i] = make_float4(to.x, to.y, to.z, point.w);
  normals[i].w = kMarkRefit;
}

__global__ void reportSums(Sums* sums, Sums* reported) {
  *reported = *sums;
  ++sums->edits;
  for (uint& word : sums->seen) word = 0;
  sums->nearest = kOutsideSheet;
}

// Collects the slots of the marked points, in any order: the cost of the refit depends on their number and not on the
// cloud's.
__global__ void __launch_bounds__(kBlock)
    collectMoved(const float4* normals, uint* movedPlaces, uint* movedCount, uint count) {
  const uint i = blockIdx.x * kBlock + threadIdx.x;
  const bool moved = i < count && normals[i].w != 0.0f;
  const unsigned marked = __ballot_sync(kAllLanes, moved);
  if (marked == 0) return;
  const uint lane = threadIdx.x % kWarp;
  uint first = 0;
  if (lane == 0) first = atomicAdd(movedCount, uint(__popc(marked)));
  first = __shfl_sync(kAllLanes, first, 0);
  if (moved) movedPlaces[first + __popc(marked & ((1u << lane) - 1))] = i;
}

// Calls visit(slot, offset) for every point nearer than `radius` to `center`, each in one lane of the warp.
template <class Visit>
__device__ void forEachNear(const CloudView& cloud, const vec3& center, float radius, Visit&& visit) {
  const ivec3 low = cellOf(cloud.grid, center - radius);
  const ivec3 high = cellOf(cloud.grid, center + radius);
  uint work = 0;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const ivec3 cell(x, y, z);
        const uint2 range = reinterpret_cast<const uint2*>(cloud.ranges)[bucketOf(cloud.grid, cell)];
        ++work;
        for (uint j = range.x + threadIdx.x % kWarp; j < range.y && work < kNeighbourWorkBudget; j += kWarp, ++work) {
          const vec3 position = xyz(loadPoint(cloud.positions, j));
          const vec3 offset = position - center;
          if (inReach(cloud, position, cell, offset, radius)) visit(j, offset);
        }
      }
}

// As in refit_normals.comp: direction of least spread (Hoppe et al. 1992, section 3.2) on the side of the normals
// around.
__device__ vec3 fittedNormal(const CloudView& cloud, const vec3& center, const vec3& old, float radius) {
  Moments m{0.0f, 0, vec3(0.0f), vec3(0.0f), vec3(0.0f)};
  vec3 side(0.0f);
  forEachNear(cloud, center, radius, [&](uint slot, const vec3& offset) {
    const vec3 normal = xyz(loadPoint(cloud.normals, slot));
    const float share = fitShare(glm::dot(normal, old));
    if (share <= 0.0f) return;
    const float w = share * wendland(glm::length(offset) / radius);
    addNeighbour(m, offset, w);
    side += w * normal;
  });
  side = warpSum(side);
  vec3 normal = planeNormal(
      Moments{warpSum(m.weight), warpSum(m.neighbours), warpSum(m.mean), warpSum(m.diagonal), warpSum(m.mixed)});
  if (glm::dot(normal, normal) < 0.5f)
    normal = old;
  else if (glm::dot(normal, old) < 0.0f)
    normal = -normal;
  return glm::dot(normal, side) < 0.0f ? -normal : normal;
}

// The fitted normal of a point on the side to which the stroke has carried the surface.
__device__ vec3 sidedNormal(const CloudView& cloud, const Tables& tables, const vec3& center, uint id,
                            const vec3& fitted, float radius) {
  const Found& own = tables.founds[id];
  if (own.stroke == 0 || glm::dot(fitted, own.normal) > kCarriedFar) return fitted;
  const CarriedFrom from = carriedFrom(own.position, own.normal);
  vec3 u, v;
  frameAround(fitted, u, v);
  CarriedSums sums{};
  forEachNear(cloud, center, radius, [&](uint slot, const vec3& offset) {
    const Found& found = tables.founds[__float_as_uint(loadPoint(cloud.positions, slot).w)];
    if (found.stroke > own.stroke) return;  // moved since by a later one
    if (found.stroke == own.stroke)
      addCarried(sums, from, offset, u, v, found.position, found.normal, radius);
    else
      addCarried(sums, from, offset, u, v, center + offset, xyz(loadPoint(cloud.normals, slot)), radius);
  });
  const float side = carriedSide(CarriedSums{warpSum(sums.means), warpSum(sums.products), warpSum(sums.found),
                                             warpSum(sums.present), warpSum(sums.weight)});
  return side < kTurnedOver ? -fitted : fitted;
}

// Whether the brush moves a neighbour, or does not reach it.
__device__ bool movesAlong(const Tables& tables, uint id, const vec3& position, const vec3& normal) {
  const BrushTool& tool = tables.tool->tool;
  const vec3 away = position - tool.middle;
  return tables.founds[id].stroke == tool.stroke || !(glm::dot(away, away) < tool.reach * tool.reach) ||
         isActedOn(*tables.tool, {position, normal, 0.0f});
}

// As noteAhead() of request.comp: how far the point of this slot may go on.
__device__ float roomOf(const CloudView& cloud, const Tables& tables, uint self) {
  const Brush& brush = tables.brush;
  const BrushTool& tool = tables.tool->tool;
  const float4 point = loadPoint(cloud.positions, self);
  const vec3 center = xyz(point);
  const uint id = __float_as_uint(point.w);
  const Found& own = tables.founds[id];
  const float spacing = tables.spacings[id], radius = neighbourhoodRadius(spacing, tables.radius);
  const Path path = pathOf(brush, tool, center, FoundPoint{own.position, own.normal, 0.0f, 0.0f}, spacing);
  float free = kFreeAhead * radius;
  forEachNear(cloud, center, radius, [&](uint slot, const vec3& offset) {
    if (slot == self) return;
    const uint other = __float_as_uint(loadPoint(cloud.positions, slot).w);
    const Found& found = tables.founds[other];
    if (tables.blockedIn[other] != 0 && found.stroke == tool.stroke)
      free = freeBeside(brush, path, offset, found.position - (center + offset), found.normal, free);
    if (!isBeside(path, offset)) return;
    // For most neighbours it does not matter whether the brush moves them, which takes loads to find out.
    const vec3 normal = xyz(loadPoint(cloud.normals, slot));
    const float along = freeUntil(brush, tool, path, SeenPoint{offset, normal, true}, free);
    const float staying = freeUntil(brush, tool, path, SeenPoint{offset, normal, false}, free);
    free = along == staying || movesAlong(tables, other, center + offset, normal) ? along : staying;
  });
  return __uint_as_float(__reduce_min_sync(kAllLanes, __float_as_uint(free)));  // not negative
}

// Calls body(which) for each moved point, in a warp, in a grid-stride loop.
template <class Body>
__device__ void forEachMoved(const uint* movedCount, Body&& body) {
  const uint warps = gridDim.x * (kBlock / kWarp);
  for (uint which = (blockIdx.x * kBlock + threadIdx.x) / kWarp; which < *movedCount; which += warps) body(which);
}

__global__ void __launch_bounds__(kBlock)
    fitNormals(const __grid_constant__ CloudView cloud, const __grid_constant__ Tables tables, const uint* moved,
               const uint* movedCount, float4* fittedNormals) {
  forEachMoved(movedCount, [&](uint which) {
    const uint slot = moved[which];
    const float4 point = loadPoint(cloud.positions, slot);
    const uint id = __float_as_uint(point.w);
    const float radius = neighbourhoodRadius(tables.spacings[id], tables.radius);
    const vec3 fitted = fittedNormal(cloud, xyz(point), xyz(loadPoint(cloud.normals, slot)), radius);
    const vec3 normal = sidedNormal(cloud, tables, xyz(point), id, fitted, radius);
    if (threadIdx.x % kWarp != 0) return;
    fittedNormals[which] = make_float4(normal.x, normal.y, normal.z, 0.0f);
    // It looks ahead again: only if this edit has found no room does it hold up others.
    if (tables.blockedIn[id] != tables.sums->edits) tables.blockedIn[id] = 0;
  });
}

__global__ void __launch_bounds__(kBlock) setNormals(const __grid_constant__ CloudView cloud, const uint* moved,
                                                     const uint* movedCount, const float4* fitted) {
  const uint threads = gridDim.x * kBlock;
  for (uint which = blockIdx.x * kBlock + threadIdx.x; which < *movedCount; which += threads)
    reinterpret_cast<float4*>(cloud.normals)[moved[which]] = fitted[which];
}

__global__ void __launch_bounds__(kBlock)
    lookAhead(const __grid_constant__ CloudView cloud, const __grid_constant__ Tables tables, const uint* moved,
              const uint* movedCount) {
  forEachMoved(movedCount, [&](uint which) {
    const uint slot = moved[which];
    const float room = roomOf(cloud, tables, slot);
    if (threadIdx.x % kWarp == 0) tables.founds[__float_as_uint(loadPoint(cloud.positions, slot).w)].room = room;
  });
}

float4* points(const DeviceArray<Vec4>& array) { return reinterpret_cast<float4*>(const_cast<Vec4*>(array.data())); }

// Enough blocks to fill the GPU for any number of moved points.
unsigned fillingBlocks() {
  int processors = 0, blocks = 0;
  checkCuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, 0),
            "reading the number of multiprocessors");
  checkCuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, lookAhead, kBlock, 0), "reading the occupancy");
  return static_cast<unsigned>(processors * blocks);
}

}  // namespace

PushEdit::PushEdit(const Brush& brush, double radius, std::span<const float> spacings, const Stream& stream)
    : brush_(brush),
      radius_(static_cast<float>(radius)),
      movedBlocks_(fillingBlocks()),
      toolHere_(1),
      founds_(spacings.size()),
      blockedIn_(spacings.size()),
      spacings_(spacings.size()),
      sums_(1),
      moved_(spacings.size()),
      movedCount_(1),
      fitted_(spacings.size()) {
  founds_.clear(stream);
  blockedIn_.clear(stream);
  spacings_.upload(spacings, stream);
  sums_.upload(std::array{Sums{}}, stream);
}

PushEdit::Tables PushEdit::tables() const {
  return {.brush = brush_,
          .radius = radius_,
          .tool = toolHere_.data(),
          .founds = founds_.data(),
          .blockedIn = blockedIn_.data(),
          .spacings = spacings_.data(),
          .sums = sums_.data()};
}

void PushEdit::recordPush(const Stream& stream, const CloudHalf& half, std::uint32_t count) const {
  if (count == 0) return;
  // Copied to the device: every thread reads it, which over the bus would take longer than the push.
  checkCuda(cudaMemcpyAsync(toolHere_.data(), &tool_.host(), sizeof(PlacedTool), cudaMemcpyHostToDevice, stream.get()),
            "writing the tool");
  pushPoints<<<blocksFor(count), kBlock, 0, stream.get()>>>(points(half.positions), points(half.normals), tables(),
                                                            count);
  reportSums<<<1, 1, 0, stream.get()>>>(sums_.data(), reported_.device());
  checkLaunch("launching the push");
}

void PushEdit::recordSequel(const Stream& stream, const CloudView& cloud) const {
  if (cloud.slots == 0) return;
  checkCuda(cudaMemsetAsync(movedCount_.data(), 0, sizeof(std::uint32_t), stream.get()), "clearing a count");
  const std::uint32_t* const moved = moved_.data();
  const std::uint32_t* const count = movedCount_.data();
  float4* const fitted = points(fitted_);
  collectMoved<<<blocksFor(cloud.slots), kBlock, 0, stream.get()>>>(reinterpret_cast<const float4*>(cloud.normals),
                                                                    moved_.data(), movedCount_.data(), cloud.slots);
  fitNormals<<<movedBlocks_, kBlock, 0, stream.get()>>>(cloud, tables(), moved, count, fitted);
  setNormals<<<movedBlocks_, kBlock, 0, stream.get()>>>(cloud, moved, count, fitted);
  lookAhead<<<movedBlocks_, kBlock, 0, stream.get()>>>(cloud, tables(), moved, count);
  checkLaunch("launching the refit of normals and the look ahead");
}

}  // namespace palpate::cu
