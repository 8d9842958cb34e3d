#pragma once

#include <memory>
#include <string>

#include "engine/core/depth_stream.hpp"
#include "engine/io/camera_text.hpp"

namespace palpate {

/// A depth camera that the system knows as a video device and that speaks Z16, depth of 16 bits, in the size of
/// `camera`; millimetres where that says no scale. Its frames have no colours and no poses. Throws Error for a device
/// that is missing, denied or something else, and where a system has no such devices.
std::shared_ptr<DepthStream> openDepthCamera(const std::string& device, const CameraText& camera);

}  // namespace palpate
