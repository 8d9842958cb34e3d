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

template <class IsThere, class Position, class Normal>
void LiveCloud::upload(Queue& queue, const Half& half, IsThere&& isThere, Position&& position, Normal&& normal) const {
  const auto put = [&](const Buffer& to, auto&& valueOf) {
    uploadMade(device_, queue, to, slots_ * sizeof(Vec4), [&](std::uint64_t offset, std::span<std::byte> piece) {
      const std::size_t first = offset / sizeof(Vec4);
      parallelFor(piece.size() / sizeof(Vec4), 0, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const Vec4 value = valueOf(first + k);
          std::memcpy(piece.data() + k * sizeof value, &value, sizeof value);
        }
      });
    });
  };
  put(half.positions, [&](std::size_t i) {
    if (!isThere(i)) return Vec4(0, 0, 0, std::bit_cast<float>(shared::kEmptySlot));
    return Vec4(position(i), std::bit_cast<float>(static_cast<std::uint32_t>(i)));
  });
  put(half.normals, [&](std::size_t i) { return isThere(i) ? normal(i) : Vec4(0); });
}

void LiveCloud::upload(Queue& queue, const PointCloud& cloud, const Half& half) const {
  PALPATE_CHECK_LE(cloud.size(), std::size_t{slots_});
  const std::size_t count = cloud.size(), colors = colored_ ? cloud.colors.size() : 0;
  upload(
      queue, half, [&](std::size_t i) { return i < count; }, [&](std::size_t i) { return cloud.positions[i]; },
      [&](std::size_t i) {
        const auto bits = [&] { return bitsOfColor(cloud.colors[i][0], cloud.colors[i][1], cloud.colors[i][2]); };
        return Vec4(cloud.normals[i], i < colors ? std::bit_cast<float>(bits()) : 0);
      });
}

void LiveCloud::upload(Queue& queue, std::span<const PointState> states, const PointSet& without,
                       const Half& half) const {
  PALPATE_CHECK(!colored_);
  constexpr std::size_t kBits = 64;
  const std::vector<std::uint64_t> left = without.bits(states.size());
  const auto isThere = [&](std::size_t i) {
    return i < states.size() && !states[i].gone && (left[i / kBits] >> i % kBits & 1) == 0;
  };
  upload(
      queue, half, isThere, [&](std::size_t i) { return states[i].position; },
      [&](std::size_t i) { return Vec4(states[i].normal, 0); });
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
