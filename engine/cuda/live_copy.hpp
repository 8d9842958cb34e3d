#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/cuda/cub_hash_build.hpp"

namespace palpate::cu {

/// The cloud on the GPU in two orders, one of which is the front.
class LiveCopy {
 public:
  /// `cloud` must have normals; uploads it.
  LiveCopy(const PointCloud& cloud, const Stream& stream);

  std::uint32_t count() const { return count_; }
  unsigned parity() const { return current_; }
  void flip() { current_ = 1 - current_; }
  CloudHalf& half(unsigned parity) { return halves_[parity]; }

  /// Writes the present positions and normals into `cloud`, which must be the one passed to the constructor; returns
  /// the number of moved points. Waits for `stream`.
  std::size_t readBack(PointCloud& cloud, const Stream& stream) const;

 private:
  std::uint32_t count_;
  CloudHalf halves_[2];
  unsigned current_ = 0;
};

}  // namespace palpate::cu
