// Which images saw each point of a dense reconstruction: the file NAME.ply.vis that COLMAP's stereo fusion writes
// beside NAME.ply (COLMAP's manual, "Output Format", "Dense Reconstruction").
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

namespace palpate {

/// Little-endian: u64 points; then for each point u32 views, and so many u32, each the place of an image in the file of
/// images, counted from 0; not its id.
struct ColmapViewsOf {
  std::filesystem::path cloud;  ///< the file whose points these are, for messages
  std::uint64_t points = 0;     ///< that it has
  std::uint64_t images = 0;     ///< of the model that was fused
};

/// Calls `visit` with the number of each point and the images that saw it, in the order of the cloud, and `progress`
/// with the share that is read. Throws FileError, with the byte and what to do, for another number of points, for what
/// ends too early or goes on too long, and for images that the model has not.
void readColmapViews(const std::filesystem::path& file, const ColmapViewsOf& what,
                     const std::function<void(std::uint64_t, std::span<const std::uint32_t>)>& visit,
                     const std::function<void(double)>& progress = {});

}  // namespace palpate
