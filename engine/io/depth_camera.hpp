#pragma once

#include <memory>
#include <string>

#include "engine/core/depth_stream.hpp"
#include "engine/io/camera_text.hpp"

namespace palpate {

/// A depth camera that is a video device with format Z16 (16-bit depth) in the size of `camera`; depth is in
/// millimetres if `camera` has no scale. Its frames have no colours and no poses. Throws Error for a device that is
/// missing, inaccessible or of another kind, and on systems without such devices.
std::shared_ptr<DepthStream> openDepthCamera(const std::string& device, const CameraText& camera);

}  // namespace palpate
