// A recorded depth camera as one cloud, for commands that take a cloud from a file.
#pragma once

#include <filesystem>

#include "apps/cli/context.hpp"
#include "engine/io/cloud_format.hpp"
#include "engine/io/rgbd_folder.hpp"

namespace palpate {

struct FusedFolder {
  StoredCloud stored;        ///< in metres
  std::string kind;          ///< as RgbdFolder::kind()
  std::uint64_t frames = 0;  ///< that the folder has
  std::uint64_t fused = 0;
  std::uint64_t unplaced = 0;  ///< without a pose, and none was found
  std::uint64_t lost = 0;      ///< that could not be read
};

/// Fuses all frames of a folder that isRgbdFolder(): from their poses, and where they have none, from those that are
/// found. What is left out is said. Throws FileError where nothing is left.
FusedFolder readFused(Context& context, const std::filesystem::path& folder, const RgbdOptions& options);

}  // namespace palpate
