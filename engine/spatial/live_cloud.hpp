#pragma once

#include <array>
#include <cstdint>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_state.hpp"
#include "engine/gpu/buffer.hpp"

namespace palpate {

class Queue;

/// A colour as it stands beside a normal: red in the lowest byte, and the highest one 0, so that the bits are those of
/// no NaN.
inline std::uint32_t bitsOfColor(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  return std::uint32_t{red} | std::uint32_t{green} << 8 | std::uint32_t{blue} << 16;
}
inline std::array<std::uint8_t, 3> colorOfBits(std::uint32_t bits) {
  return {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits >> 16)};
}

/// The cloud that is touched, on the GPU: positions and normals in the order of the spatial hash, each point with its
/// id (its place in the file). There are two copies, because a rebuild reads one order and writes the next; `front()`
/// is the one that counts. A slot holds a point or is empty (id kEmptySlot); spare slots let an index grow where points
/// gather. Owned by the touch side; nobody else reads it while a tick runs.
class LiveCloud {
 public:
  struct Half {
    Buffer positions;  ///< a vec4 a slot: xyz in model units relative to the cloud's origin, w the bits of the id
    Buffer normals;    ///< a vec4 a slot: xyz unit, w 0 or the bits of a colour (bitsOfColor())
    std::uint32_t parity = 0;
  };

  /// `cloud` must have normals. `spare`: empty slots behind its points. Throws OutOfGpuMemory.
  /// `queue`: on which it is uploaded; that of touch unless given. `colored`: its colours stand beside the normals.
  LiveCloud(Device& device, const PointCloud& cloud, std::uint32_t spare = 0, Queue* queue = nullptr,
            bool colored = false);

  /// Points as the cloud was loaded.
  std::uint32_t count() const { return count_; }
  std::uint32_t slots() const { return slots_; }
  const Half& front() const { return halves_[current_]; }
  const Half& back() const { return halves_[1 - current_]; }
  const Half& half(std::uint32_t parity) const { return halves_[parity]; }
  /// 0 or 1: which half counts, for command lists recorded ahead for both.
  std::uint32_t parity() const { return current_; }
  void flip() { current_ = 1 - current_; }

  /// The points that are there, in the order of their slots. Waits for the latency queue.
  std::vector<PointState> points() const;
  /// Puts the points of a cloud, as many as slots at most, into memory of that many slots, in the order of their ids,
  /// as the first half had them. Waits for `queue`.
  void upload(Queue& queue, const PointCloud& cloud, const Half& half) const;

 private:
  Device& device_;
  std::uint32_t count_, slots_;
  bool colored_;
  Half halves_[2];
  std::uint32_t current_ = 0;
};

}  // namespace palpate
