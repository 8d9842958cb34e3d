#include "engine/cuda/cuda_measure.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/cuda/cuda_error.hpp"
#include "engine/cuda/live_copy.hpp"
#include "engine/cuda/move_points.hpp"

namespace palpate {

namespace {

// Runs `graph` once and says how long it took on the GPU.
double timed_us(const cu::Graph& graph, const cu::Stream& stream) {
  cu::Event start, end;
  start.record(stream);
  graph.launch(stream);
  end.record(stream);
  end.synchronize("measuring");
  return end.since_us(start);
}

}  // namespace

CubSortTimes timeCubSort(std::span<const std::uint32_t> keys, unsigned bits, int repeat) {
  cudaDeviceName();  // the plain error where there is no GPU
  const auto count = static_cast<std::uint32_t>(keys.size());
  const cu::Stream stream;
  cu::DeviceArray<std::uint32_t> unsorted(count), numbers(count);
  const cu::DeviceArray<std::uint32_t> keysIn(count), keysAlt(count), valuesIn(count), valuesAlt(count);
  std::vector<std::uint32_t> ascending(count);
  std::iota(ascending.begin(), ascending.end(), 0u);
  unsorted.upload(keys, stream);
  numbers.upload(ascending, stream);
  const std::size_t scratchBytes = cu::cubSortScratchBytes(count, bits);
  const cu::DeviceArray<std::byte> scratch(scratchBytes);
  const auto restore = [&](const auto& from, const auto& to) {
    cu::checkCuda(
        cudaMemcpyAsync(to.data(), from.data(), sizeof(std::uint32_t) * count, cudaMemcpyDeviceToDevice, stream.get()),
        "bringing back the unsorted keys");
  };
  const cu::PairBuffers pairs{{keysIn.data(), keysAlt.data()}, {valuesIn.data(), valuesAlt.data()}};
  const cu::Graph sort(stream, [&] { cu::cubSort(pairs, count, bits, scratch.data(), scratchBytes, stream.get()); });
  CubSortTimes times;
  for (int i = 0; i < repeat; ++i) {
    restore(unsorted, keysIn);
    restore(numbers, valuesIn);
    times.push_back(timed_us(sort, stream));
  }
  return times;
}

CubBuildTimes timeCubBuild(const PointCloud& cloud, const shared::HashGrid& grid, int repeat, double movedShare) {
  cudaDeviceName();
  const cu::Stream stream;
  cu::LiveCopy live(cloud, stream);
  cu::CubBuild build(grid, live.count());
  const auto graphFrom = [&](unsigned parity) {
    return cu::Graph(stream, [&] { build.record(stream, live.side(parity), live.side(1 - parity), live.count()); });
  };
  const cu::Graph graphs[2] = {graphFrom(0), graphFrom(1)};
  const auto period = movedShare > 0 ? static_cast<std::uint32_t>(std::clamp(std::round(1 / movedShare), 1.0, 4e9)) : 0;
  CubBuildTimes times;
  for (int i = 0; i <= repeat; ++i) {
    if (i > 0 && period > 0) {
      // A cell and a half there and back again, so that the cloud stays where it is over many builds.
      const auto round = static_cast<std::uint32_t>(i - 1);
      const float offset = (round % 2 ? -1.5f : 1.5f) / grid.inverseCell;
      cu::launchMovePoints(live.side(live.parity()), live.count(), period, round / 2 % period, offset, stream);
    }
    const double time_us = timed_us(graphs[live.parity()], stream);
    if (i == 0)
      times.first_us = time_us;
    else
      times.steady_us.push_back(time_us);
    live.flip();
  }
  return times;
}

}  // namespace palpate
