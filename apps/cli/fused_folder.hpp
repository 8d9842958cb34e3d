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
  std::uint64_t frames = 0;  ///< in the folder
  std::uint64_t fused = 0;
  std::uint64_t unplaced = 0;  ///< without a pose, and tracking failed
  std::uint64_t lost = 0;      ///< unreadable ones
};

/// Fuses all frames of a folder with isRgbdFolder(), at their own poses, or at tracked ones if they have none. Logs the
/// frames left out. Throws FileError if no points remain.
FusedFolder readFused(Context& context, const std::filesystem::path& folder, const RgbdOptions& options);

}  // namespace palpate
