#include "engine/cuda/live_copy.hpp"

#include <bit>
#include <limits>

#include "engine/cloud/placed_points.hpp"
#include "engine/core/check.hpp"
#include "engine/cuda/cuda_error.hpp"

namespace palpate::cu {

namespace {

std::uint32_t checkedCount(const PointCloud& cloud) {
  if (cloud.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throw CudaError("CUDA: {} points are more than the index can number; use a smaller model", cloud.size());
  PALPATE_CHECK_EQ(cloud.normals.size(), cloud.size());
  return static_cast<std::uint32_t>(cloud.size());
}

}  // namespace

LiveCopy::LiveCopy(const PointCloud& cloud, const Stream& stream)
    : count_(checkedCount(cloud)), halves_{CloudHalf(count_), CloudHalf(count_)} {
  std::vector<Vec4> packed(count_);
  for (std::uint32_t i = 0; i < count_; ++i) packed[i] = Vec4(cloud.positions[i], std::bit_cast<float>(i));
  halves_[0].positions.upload(packed, stream);
  for (std::uint32_t i = 0; i < count_; ++i) packed[i] = Vec4(cloud.normals[i], 0.0f);
  halves_[0].normals.upload(packed, stream);
}

std::size_t LiveCopy::readBack(PointCloud& cloud, const Stream& stream) const {
  const CloudHalf& half = halves_[current_];
  return takeBack(cloud, half.positions.download(stream), half.normals.download(stream));
}

}  // namespace palpate::cu
