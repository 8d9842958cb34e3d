#include "engine/spatial/live_cloud.hpp"

#include <bit>
#include <limits>

#include "engine/cloud/placed_points.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

std::uint32_t checkedCount(const Device& device, const PointCloud& cloud) {
  if (cloud.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throw OutOfGpuMemory("{}: {} points are more than the index can number", device.name(), cloud.size());
  PALPATE_CHECK_EQ(cloud.normals.size(), cloud.size());
  return static_cast<std::uint32_t>(cloud.size());
}

LiveCloud::Side makeSide(Device& device, std::uint32_t count) {
  return {Buffer::of<Vec4>(device, count, Memory::device, "live positions"),
          Buffer::of<Vec4>(device, count, Memory::device, "live normals")};
}

}  // namespace

LiveCloud::LiveCloud(Device& device, const PointCloud& cloud)
    : device_(device), count_(checkedCount(device, cloud)), sides_{makeSide(device, count_), makeSide(device, count_)} {
  std::vector<Vec4> packed(count_);
  for (std::uint32_t i = 0; i < count_; ++i) packed[i] = Vec4(cloud.positions[i], std::bit_cast<float>(i));
  upload(device, sides_[0].positions, packed);
  for (std::uint32_t i = 0; i < count_; ++i) packed[i] = Vec4(cloud.normals[i], 0.0f);
  upload(device, sides_[0].normals, packed);
}

std::size_t LiveCloud::readBack(PointCloud& cloud) const {
  return takeBack(cloud, download<Vec4>(device_, side().positions, count_),
                  download<Vec4>(device_, side().normals, count_));
}

}  // namespace palpate
