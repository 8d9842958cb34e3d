#include "engine/cuda/move_points.hpp"

namespace palpate::cu {

namespace {

constexpr unsigned kBlock = 256;

__global__ void __launch_bounds__(kBlock)
    movePoints(float4* positions, shared::uint count, shared::uint period, shared::uint phase, float offset) {
  const shared::uint i = blockIdx.x * kBlock + threadIdx.x;
  if (i < count && __float_as_uint(positions[i].w) % period == phase) positions[i].x += offset;
}

}  // namespace

void launchMovePoints(const CloudSide& side, std::uint32_t count, std::uint32_t period, std::uint32_t phase,
                      float offset, const Stream& stream) {
  if (count == 0) return;
  movePoints<<<(count - 1) / kBlock + 1, kBlock, 0, stream.get()>>>(reinterpret_cast<float4*>(side.positions.data()),
                                                                    count, period, phase, offset);
  checkLaunch("moving points");
}

}  // namespace palpate::cu
