#include "engine/spatial/live_cloud.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

namespace {

std::uint32_t checkedCount(const Device& device, const PointCloud& cloud) {
  if (cloud.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throw OutOfGpuMemory("{}: {} points are more than the index can number", device.name(), cloud.size());
  PALPATE_CHECK_EQ(cloud.normals.size(), cloud.size());
  return static_cast<std::uint32_t>(cloud.size());
}

std::uint32_t checkedSlots(const Device& device, std::uint32_t count, std::uint32_t spare) {
  const std::uint64_t slots = std::uint64_t{count} + spare;
  if (slots > std::numeric_limits<std::uint32_t>::max() / 2)
    throw OutOfGpuMemory("{}: {} points with room to grow are more than the index can number", device.name(), slots);
  return static_cast<std::uint32_t>(slots);
}

LiveCloud::Half makeHalf(Device& device, std::uint32_t slots, std::uint32_t parity) {
  return {Buffer::of<Vec4>(device, slots, Memory::device, "live positions"),
          Buffer::of<Vec4>(device, slots, Memory::device, "live normals"), parity};
}

}  // namespace

LiveCloud::LiveCloud(Device& device, const PointCloud& cloud, std::uint32_t spare, Queue* queue, bool colored)
    : device_(device),
      count_(checkedCount(device, cloud)),
      slots_(checkedSlots(device, count_, spare)),
      colored_(colored),
      halves_{makeHalf(device, slots_, 0), makeHalf(device, slots_, 1)} {
  upload(queue ? *queue : latencyQueueOf(device), cloud, halves_[0]);
}

void LiveCloud::upload(Queue& queue, const PointCloud& cloud, const Half& half) const {
  PALPATE_CHECK_LE(cloud.size(), std::size_t{slots_});
  std::vector<Vec4> packed(slots_, Vec4(0, 0, 0, std::bit_cast<float>(shared::kEmptySlot)));
  for (std::uint32_t i = 0; i < cloud.size(); ++i) packed[i] = Vec4(cloud.positions[i], std::bit_cast<float>(i));
  palpate::upload(device_, queue, half.positions, packed);
  std::ranges::fill(packed, Vec4(0));
  for (std::uint32_t i = 0; i < cloud.size(); ++i) packed[i] = Vec4(cloud.normals[i], 0.0f);
  for (std::uint32_t i = 0; colored_ && i < cloud.colors.size(); ++i)
    packed[i].w = std::bit_cast<float>(bitsOfColor(cloud.colors[i][0], cloud.colors[i][1], cloud.colors[i][2]));
  palpate::upload(device_, queue, half.normals, packed);
}

std::vector<PointState> LiveCloud::points() const {
  const auto positions = download<Vec4>(device_, front().positions, slots_);
  const auto normals = download<Vec4>(device_, front().normals, slots_);
  std::vector<PointState> points;
  points.reserve(count_);
  for (std::size_t slot = 0; slot < positions.size(); ++slot) {
    const auto id = std::bit_cast<std::uint32_t>(positions[slot].w);
    if (id == shared::kEmptySlot) continue;
    points.push_back({.position = Vec3(positions[slot]), .id = id, .normal = Vec3(normals[slot]), .parent = id});
  }
  return points;
}

}  // namespace palpate
