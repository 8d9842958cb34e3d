#include <bit>

#include "engine/cuda/cub_hash_build.hpp"

namespace palpate::cu {

namespace {

using namespace shared;

constexpr unsigned kBlock = 256;

unsigned blocksFor(std::uint64_t threads) { return static_cast<unsigned>((threads + kBlock - 1) / kBlock); }

// As shaders/spatial/hash_keys.comp, but clears the ranges in the same launch, which saves one.
__global__ void __launch_bounds__(kBlock)
    writeKeys(const float4* __restrict__ positions, HashGrid grid, uint count, uint* __restrict__ keys,
              uint* __restrict__ order, uint2* __restrict__ ranges) {
  const uint i = blockIdx.x * kBlock + threadIdx.x;
  if (i <= grid.bucketMask) ranges[i] = make_uint2(0, 0);
  if (i >= count) return;
  const float4 p = positions[i];
  keys[i] = bucketOf(grid, cellOf(grid, vec3(p.x, p.y, p.z)));
  order[i] = i;
}

// As shaders/spatial/hash_reorder.comp.
__global__ void __launch_bounds__(kBlock)
    reorder(const uint* __restrict__ keys, const uint* __restrict__ order, uint count,
            const float4* __restrict__ positionsIn, const float4* __restrict__ normalsIn,
            float4* __restrict__ positionsOut, float4* __restrict__ normalsOut, uint2* __restrict__ ranges) {
  const uint i = blockIdx.x * kBlock + threadIdx.x;
  if (i >= count) return;
  const uint from = order[i];
  const float4 position = positionsIn[from];
  const float4 normal = normalsIn[from];
  const uint key = keys[i];
  if (i == 0 || keys[i - 1] != key) ranges[key].x = i;
  if (i + 1 == count || keys[i + 1] != key) ranges[key].y = i + 1;
  positionsOut[i] = position;
  normalsOut[i] = normal;
}

float4* quads(const DeviceArray<vec4>& values) { return reinterpret_cast<float4*>(values.data()); }

}  // namespace

CubBuild::CubBuild(const HashGrid& grid, std::uint32_t capacity)
    : grid_(grid),
      keyBits_(static_cast<unsigned>(std::bit_width(grid.bucketMask))),
      keys_(capacity),
      order_(capacity),
      keysAlt_(capacity),
      orderAlt_(capacity),
      ranges_(std::size_t{grid.bucketMask} + 1),
      scratch_(cubSortScratchBytes(capacity, keyBits_)) {}

void CubBuild::record(const Stream& stream, const CloudHalf& from, const CloudHalf& to, std::uint32_t count) {
  const std::uint64_t threads = std::max<std::uint64_t>(count, std::uint64_t{grid_.bucketMask} + 1);
  uint2* const ranges = reinterpret_cast<uint2*>(ranges_.data());
  writeKeys<<<blocksFor(threads), kBlock, 0, stream.get()>>>(quads(from.positions), grid_, count, keys_.data(),
                                                             order_.data(), ranges);
  checkLaunch("writing the keys of the index");
  if (count == 0) return;
  const unsigned sorted = cubSort({{keys_.data(), keysAlt_.data()}, {order_.data(), orderAlt_.data()}}, count, keyBits_,
                                  scratch_.data(), scratch_.size(), stream.get());
  const auto& keys = sorted ? keysAlt_ : keys_;
  const auto& order = sorted ? orderAlt_ : order_;
  reorder<<<blocksFor(count), kBlock, 0, stream.get()>>>(keys.data(), order.data(), count, quads(from.positions),
                                                         quads(from.normals), quads(to.positions), quads(to.normals),
                                                         ranges);
  checkLaunch("reordering the points");
}

CloudView CubBuild::view(const CloudHalf& half, std::uint32_t count) const {
  const auto address = [](const void* pointer) { return reinterpret_cast<std::uint64_t>(pointer); };
  return {.positions = address(half.positions.data()),
          .normals = address(half.normals.data()),
          .ranges = address(ranges_.data()),
          .grid = grid_,
          .slots = count,
          .unused = 0};
}

}  // namespace palpate::cu
