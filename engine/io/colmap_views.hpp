// The images that saw each point of a dense reconstruction: the file NAME.ply.vis that COLMAP's stereo fusion writes
// beside NAME.ply (COLMAP's manual, "Output Format", "Dense Reconstruction").
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

namespace palpate {

/// Little-endian: u64 number of points; then for each point u32 number of views, and for each view u32 index of its
/// image in the images file, from 0 (not its id).
struct ColmapViewsOf {
  std::filesystem::path cloud;  ///< the file with these points, for messages
  std::uint64_t points = 0;     ///< number of points in it
  std::uint64_t images = 0;     ///< number of images of the fused model
};

/// Calls `visit` with the number of each point and the images that saw it, in the order of the cloud, and `progress`
/// with the share that was read. Throws FileError, with the byte and what to do, if the number of points differs, if
/// the file is too short or too long, and for images that are not in the model.
void readColmapViews(const std::filesystem::path& file, const ColmapViewsOf& what,
                     const std::function<void(std::uint64_t, std::span<const std::uint32_t>)>& visit,
                     const std::function<void(double)>& progress = {});

}  // namespace palpate
