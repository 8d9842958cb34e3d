#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/gpu/buffer.hpp"

namespace palpate {

/// The cloud that is touched, on the GPU: positions and normals in the order of the spatial hash, each point with its
/// id (its place in the file). There are two copies, because a rebuild reads one order and writes the next; `side()` is
/// the one that counts. Owned by the touch side; nobody else reads it while a tick runs.
class LiveCloud {
 public:
  struct Side {
    Buffer positions;  ///< count vec4: xyz in model units relative to the cloud's origin, w the bits of the id
    Buffer normals;    ///< count vec4: xyz unit, w 0
  };

  /// `cloud` must have normals. Throws OutOfGpuMemory.
  LiveCloud(Device& device, const PointCloud& cloud);

  std::uint32_t count() const { return count_; }
  const Side& side() const { return sides_[current_]; }
  const Side& otherSide() const { return sides_[1 - current_]; }
  /// 0 or 1: which side counts, for command lists recorded ahead for both.
  std::uint32_t parity() const { return current_; }
  void flip() { current_ = 1 - current_; }

  /// Writes the present positions and normals into `cloud`, which must be the one this was made from; says how many
  /// points moved. Waits for the touch queue.
  std::size_t readBack(PointCloud& cloud) const;

 private:
  Device& device_;
  std::uint32_t count_;
  Side sides_[2];
  std::uint32_t current_ = 0;
};

}  // namespace palpate
