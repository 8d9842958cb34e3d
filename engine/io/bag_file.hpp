#pragma once

#include <filesystem>

namespace palpate {

/// Throws FileError, which says what makes a folder of frames of it, for a file in which ROS or a RealSense camera has
/// recorded; by its first bytes, of a regular file alone.
void refuseBag(const std::filesystem::path& file);

}  // namespace palpate
