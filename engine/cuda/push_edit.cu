#include "engine/cuda/push_edit.hpp"

#include <array>

#include "engine/cuda/gather_plan.cuh"
#include "shaders/shared/brush.h"
#include "shaders/shared/plane_fit.h"

namespace palpate::cu {

namespace {

constexpr unsigned kBlock = 256;

using Sums = PushEdit::Sums;

unsigned blocksFor(std::uint32_t threads) { return threads / kBlock + (threads % kBlock != 0); }

__device__ bool isActedOn(const PlacedTool& placed, const FoundPoint& found) {
  const uint cell = connectedCell(placed.tool, found);
  return (placed.connected[cell / 32] >> cell % 32 & 1) != 0;
}

__global__ void __launch_bounds__(kBlock) pushPoints(float4* positions, float4* normals, const PlacedTool* tools,
                                                     Found* founds, Sums* sums, uint count, const Brush brush) {
  const uint i = blockIdx.x * kBlock + threadIdx.x;
  const BrushTool tool = tools->tool;
  if (i >= count || tool.acts == 0) return;
  const float4 point = positions[i];
  const vec3 from = xyz(point), away = from - tool.middle;
  if (glm::dot(away, away) >= tool.reach * tool.reach) return;
  const uint id = __float_as_uint(point.w);
  Found& known = founds[id];
  FoundPoint found{from, xyz(normals[i]), kUnseen};
  if (known.stroke == tool.stroke) found = {known.position, known.normal, known.room};
  if (isSampled(id, tool.sampling)) {
    const MeasuredPoint says = measured(brush, tool, found);
    if (says.weight != 0 && isActedOn(*tools, found)) {
      atomicAdd(&sums->weights, uint(says.weight));
      for (int k = 0; k < 3; ++k) atomicAdd(&sums->normals[k], uint(says.normal[k]));
      atomicAdd(&sums->heights, uint(says.height));
    }
    const uint near = entered(brush, tool, from, found);
    if (near != kOutsideSheet) {
      atomicOr(&sums->seen[near % kSheetCells / 32], 1u << near % 32);
      atomicMin(&sums->nearest, near);
    }
  }
  const vec3 to = brushed(brush, tool, from, found.normal, found).position;
  if (to == from || !isActedOn(*tools, found)) return;
  known = {found.position, tool.stroke, found.normal, found.room};
  positions[i] = make_float4(to.x, to.y, to.z, point.w);
  normals[i].w = kMarkRefit;
}

__global__ void tellSums(Sums* sums, Sums* told) {
  *told = *sums;
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

// Moments of the points around `center`, summed over the warp.
__device__ Moments momentsAbout(const CloudView& cloud, const vec3& center, float radius) {
  const ivec3 low = cellOf(cloud.grid, center - radius);
  const ivec3 high = cellOf(cloud.grid, center + radius);
  Moments m{0.0f, 0, vec3(0.0f), vec3(0.0f), vec3(0.0f)};
  uint work = 0;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const ivec3 cell(x, y, z);
        const uint2 range = reinterpret_cast<const uint2*>(cloud.ranges)[bucketOf(cloud.grid, cell)];
        ++work;
        for (uint j = range.x + threadIdx.x % kWarp; j < range.y && work < kNeighbourWorkBudget; j += kWarp, ++work) {
          const vec3 position = xyz(loadPoint(cloud.positions, j));
          const vec3 d = position - center;
          if (!inReach(cloud, position, cell, d, radius)) continue;
          const float w = wendland(sqrtf(glm::dot(d, d)) / radius);
          addNeighbour(m, d, w);
        }
      }
  return {warpSum(m.weight), warpSum(m.neighbours), warpSum(m.mean), warpSum(m.diagonal), warpSum(m.mixed)};
}

// Direction of least spread (Hoppe et al. 1992, section 3.2) on the side of the old normal.
__device__ vec3 fittedNormal(const CloudView& cloud, const vec3& center, const vec3& old, float radius) {
  const vec3 normal = planeNormal(momentsAbout(cloud, center, radius));
  if (glm::dot(normal, normal) < 0.5f) return old;
  return glm::dot(normal, old) < 0.0f ? -normal : normal;
}

// One warp per moved point, in a grid-stride loop.
__global__ void __launch_bounds__(kBlock)
    refitNormals(const __grid_constant__ CloudView cloud, const uint* moved, const uint* movedCount, float radius) {
  const uint warps = gridDim.x * (kBlock / kWarp);
  for (uint which = (blockIdx.x * kBlock + threadIdx.x) / kWarp; which < *movedCount; which += warps) {
    const uint i = moved[which];
    const vec3 old = xyz(loadPoint(cloud.normals, i));
    const vec3 normal = fittedNormal(cloud, xyz(loadPoint(cloud.positions, i)), old, radius);
    if (threadIdx.x % kWarp == 0)
      reinterpret_cast<float4*>(cloud.normals)[i] = make_float4(normal.x, normal.y, normal.z, 0.0f);
  }
}

float4* points(const DeviceArray<Vec4>& array) { return reinterpret_cast<float4*>(const_cast<Vec4*>(array.data())); }

// Enough blocks to fill the GPU for any number of moved points.
unsigned fillingBlocks() {
  int processors = 0, blocks = 0;
  checkCuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, 0),
            "reading the number of multiprocessors");
  checkCuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, refitNormals, kBlock, 0), "reading the occupancy");
  return static_cast<unsigned>(processors * blocks);
}

}  // namespace

PushEdit::PushEdit(const Brush& brush, double radius, const Stream& stream, std::uint32_t points)
    : brush_(brush),
      radius_(radius),
      refitBlocks_(fillingBlocks()),
      toolHere_(1),
      founds_(points),
      sums_(1),
      moved_(points),
      movedCount_(1) {
  founds_.clear(stream);
  sums_.upload(std::array{Sums{}}, stream);
}

void PushEdit::recordPush(const Stream& stream, const CloudHalf& half, std::uint32_t count) const {
  if (count == 0) return;
  // Copied to the device: every thread reads it, which over the bus would take longer than the push.
  checkCuda(cudaMemcpyAsync(toolHere_.data(), &tool_.host(), sizeof(PlacedTool), cudaMemcpyHostToDevice, stream.get()),
            "writing the tool");
  pushPoints<<<blocksFor(count), kBlock, 0, stream.get()>>>(
      points(half.positions), points(half.normals), toolHere_.data(), founds_.data(), sums_.data(), count, brush_);
  tellSums<<<1, 1, 0, stream.get()>>>(sums_.data(), told_.device());
  checkLaunch("launching the push");
}

void PushEdit::recordRefit(const Stream& stream, const CloudView& cloud) const {
  if (cloud.slots == 0) return;
  checkCuda(cudaMemsetAsync(movedCount_.data(), 0, sizeof(std::uint32_t), stream.get()), "clearing a count");
  collectMoved<<<blocksFor(cloud.slots), kBlock, 0, stream.get()>>>(reinterpret_cast<const float4*>(cloud.normals),
                                                                    moved_.data(), movedCount_.data(), cloud.slots);
  refitNormals<<<refitBlocks_, kBlock, 0, stream.get()>>>(cloud, moved_.data(), movedCount_.data(),
                                                          static_cast<float>(radius_));
  checkLaunch("launching the refit of normals");
}

}  // namespace palpate::cu
