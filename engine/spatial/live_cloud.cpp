#include "engine/spatial/live_cloud.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "engine/core/parallel.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

namespace {

std::uint32_t checkedCount(const Device& device, std::size_t points) {
  if (points > std::numeric_limits<std::uint32_t>::max() / 2)
    throw OutOfGpuMemory("{}: {} points are more than the index can number", device.name(), points);
  return static_cast<std::uint32_t>(points);
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
      count_(checkedCount(device, cloud.size())),
      slots_(checkedSlots(device, count_, spare)),
      colored_(colored),
      halves_{makeHalf(device, slots_, 0), makeHalf(device, slots_, 1)} {
  PALPATE_CHECK_EQ(cloud.normals.size(), cloud.size());
  upload(queue ? *queue : latencyQueueOf(device), cloud, halves_[0]);
}

LiveCloud::LiveCloud(Device& device, std::span<const Vec3> positions)
    : device_(device),
      count_(checkedCount(device, positions.size())),
      slots_(count_),
      colored_(false),
      halves_{makeHalf(device, slots_, 0), makeHalf(device, slots_, 1)} {
  uploadPositions(latencyQueueOf(device), positions, halves_[0]);
}

void LiveCloud::put(Queue& queue, const Buffer& to, auto&& valueOf) const {
  uploadMade(device_, queue, to, slots_ * sizeof(Vec4), [&](std::uint64_t offset, std::span<std::byte> piece) {
    const std::size_t first = offset / sizeof(Vec4);
    parallelFor(piece.size() / sizeof(Vec4), 0, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Vec4 value = valueOf(first + k);
        std::memcpy(piece.data() + k * sizeof value, &value, sizeof value);
      }
    });
  });
}

void LiveCloud::uploadPositions(Queue& queue, std::span<const Vec3> positions, const Half& half) const {
  PALPATE_CHECK_LE(positions.size(), std::size_t{slots_});
  put(queue, half.positions, [&](std::size_t i) {
    if (i >= positions.size()) return Vec4(0, 0, 0, std::bit_cast<float>(shared::kEmptySlot));
    return Vec4(positions[i], std::bit_cast<float>(static_cast<std::uint32_t>(i)));
  });
}

void LiveCloud::upload(Queue& queue, const PointCloud& cloud, const Half& half) const {
  uploadPositions(queue, cloud.positions, half);
  const std::size_t count = cloud.size(), colors = colored_ ? cloud.colors.size() : 0;
  put(queue, half.normals, [&](std::size_t i) {
    if (i >= count) return Vec4(0);
    const auto bits = [&] { return bitsOfColor(cloud.colors[i][0], cloud.colors[i][1], cloud.colors[i][2]); };
    return Vec4(cloud.normals[i], i < colors ? std::bit_cast<float>(bits()) : 0);
  });
}

std::vector<PointState> LiveCloud::points() const {
  const auto positions = download<Vec4>(device_, front().positions, slots_);
  const auto normals = download<Vec4>(device_, front().normals, slots_);
  std::vector<PointState> points;
  points.reserve(count_);
  for (std::size_t slot = 0; slot < positions.size(); ++slot) {
    const auto id = std::bit_cast<std::uint32_t>(positions[slot].w);
    if (id == shared::kEmptySlot) continue;
    points.push_back({.position = Vec3(positions[slot]), .number = id, .normal = Vec3(normals[slot]), .parent = id});
  }
  return points;
}

}  // namespace palpate
