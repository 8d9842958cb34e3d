#pragma once

#include <array>
#include <cstdint>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_set.hpp"
#include "engine/core/point_state.hpp"
#include "engine/gpu/buffer.hpp"

namespace palpate {

class Queue;

/// A colour as stored beside a normal: red in the lowest byte, and the highest byte 0, so that the bits are not those
/// of a NaN.
inline std::uint32_t bitsOfColor(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  return std::uint32_t{red} | std::uint32_t{green} << 8 | std::uint32_t{blue} << 16;
}
inline std::array<std::uint8_t, 3> colorOfBits(std::uint32_t bits) {
  return {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits >> 16)};
}

/// The touched cloud on the GPU: positions and normals in the order of the spatial hash, each point with its id (its
/// index in the file). There are two copies, because a rebuild reads one order and writes the next; `front()` is the
/// valid one. A slot holds a point or is empty (id kEmptySlot); spare slots let the index grow where points accumulate.
/// Owned by the touch side; no other thread reads it while a tick runs.
class LiveCloud {
 public:
  struct Half {
    Buffer positions;  ///< a vec4 per slot: xyz in model units relative to the cloud's origin, w the bits of the id
    Buffer normals;    ///< a vec4 per slot: xyz unit, w 0 or the bits of a colour (bitsOfColor())
    std::uint32_t parity = 0;
  };

  /// `cloud` must have normals. `spare`: empty slots after its points. `queue`: for the upload; the latency
  /// queue by default. `colored`: its colours are stored beside the normals. Throws OutOfGpuMemory.
  LiveCloud(Device& device, const PointCloud& cloud, std::uint32_t spare = 0, Queue* queue = nullptr,
            bool colored = false);
  /// Positions alone, for passes that read no normals.
  LiveCloud(Device& device, std::span<const Vec3> positions);

  /// Number of points of the cloud as loaded.
  std::uint32_t count() const { return count_; }
  std::uint32_t slots() const { return slots_; }
  const Half& front() const { return halves_[current_]; }
  const Half& back() const { return halves_[1 - current_]; }
  const Half& half(std::uint32_t parity) const { return halves_[parity]; }
  /// 0 or 1: the parity of the front half, for command lists recorded ahead for both.
  std::uint32_t parity() const { return current_; }
  void flip() { current_ = 1 - current_; }

  /// The existing points, in the order of their slots. Waits for the latency queue.
  std::vector<PointState> points() const;
  /// Writes the points of a cloud, at most slots() of them, to memory of slots() slots, in the order of their ids, in
  /// the format of the first half. Waits for `queue`.
  void upload(Queue& queue, const PointCloud& cloud, const Half& half) const;

 private:
  // The values of all slots, by slot.
  void put(Queue& queue, const Buffer& to, auto&& valueOf) const;
  void uploadPositions(Queue& queue, std::span<const Vec3> positions, const Half& half) const;

  Device& device_;
  std::uint32_t count_, slots_;
  bool colored_;
  Half halves_[2];
  std::uint32_t current_ = 0;
};

}  // namespace palpate
