#include "engine/cuda/cuda_measure.hpp"

#include <numeric>

#include "engine/cuda/cuda_error.hpp"
#include "engine/cuda/live_copy.hpp"

namespace palpate {

namespace {

// Runs `graph` once and returns its GPU time.
double timed_us(const cu::Graph& graph, const cu::Stream& stream) {
  cu::Event start, end;
  start.record(stream);
  graph.launch(stream);
  end.record(stream);
  end.synchronize("measuring");
  return end.since_us(start);
}

}  // namespace

std::vector<double> timeCubSort(std::span<const std::uint32_t> keys, unsigned bits, int repeat) {
  cudaDeviceName();  // throws a clear error if there is no GPU
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
        "restoring the unsorted keys");
  };
  const cu::PairBuffers pairs{{keysIn.data(), keysAlt.data()}, {valuesIn.data(), valuesAlt.data()}};
  const cu::Graph sort(stream, [&] { cu::cubSort(pairs, count, bits, scratch.data(), scratchBytes, stream.get()); });
  std::vector<double> times;
  for (int i = 0; i < repeat; ++i) {
    restore(unsorted, keysIn);
    restore(numbers, valuesIn);
    times.push_back(timed_us(sort, stream));
  }
  return times;
}

std::vector<double> timeCubBuild(const PointCloud& cloud, const shared::HashGrid& grid, int repeat) {
  cudaDeviceName();
  const cu::Stream stream;
  cu::LiveCopy live(cloud, stream);
  cu::CubBuild build(grid, live.count());
  const cu::Graph graph(stream, [&] { build.record(stream, live.half(0), live.half(1), live.count()); });
  std::vector<double> times(static_cast<std::size_t>(repeat));
  for (double& time_us : times) time_us = timed_us(graph, stream);
  return times;
}

}  // namespace palpate
