// The Gaussians of a cloud in a picture.
#pragma once

#include <list>

#include "engine/gpu/command_list.hpp"
#include "engine/render/compute_raster.hpp"
#include "engine/render/frame_constants.hpp"
#include "engine/spatial/radix_sort.hpp"

namespace palpate {

/// Draws Gaussians as they were trained (Kerbl et al. 2023): projected, sorted by depth, listed in bins of pixels, and
/// composited front to back. A bin's list has a bit for each Gaussian in the order of depth, so its length is known in
/// advance and no list overflows: more Gaussians, and larger pictures, make larger bins and take longer. The same input
/// gives the same bytes.
class GaussianPass {
 public:
  explicit GaussianPass(Device& device);

  /// Projects, sorts and lists them. `cloud`: with Gaussians.
  void prepare(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target, const FrameSize& size);
  /// Composites what was prepared last over `shaded`, and writes the depth of each sample that it covers by half.
  void blend(CommandList& list, DeviceAddress shaded) const;

 private:
  /// Bins of a picture with lists of bits.
  struct Bins {
    std::uint32_t words, side_px, across, down;
    std::uint64_t bytes() const { return std::uint64_t{across} * down * words * sizeof(std::uint32_t); }
  };
  static Bins binsOf(std::uint32_t count, const FrameSize& size);
  struct Room {
    Room(Device& device, const RadixSort& sort, std::uint32_t count, std::uint64_t binBytes);
    std::uint32_t capacity;  ///< Gaussians
    Buffer projected, boxes, keys, values, keysAlt, valuesAlt, scratch, bins;
  };
  const Room& roomFor(std::uint32_t count, std::uint64_t binBytes);

  Device& device_;
  std::uint32_t tile_px_;
  RadixSort sort_;
  ComputePipeline project_, bin_, blend_;
  std::list<Room> rooms_;  // the last one is used; pictures in flight may still use earlier ones
  shared::GaussianBlendArgs args_{};
};

}  // namespace palpate
