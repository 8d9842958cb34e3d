#include "engine/core/error.hpp"
#include "engine/io/depth_camera.hpp"

namespace palpate {

std::shared_ptr<DepthStream> openDepthCamera(const std::string& device, const CameraText&) {
  throw Error("{}: depth cameras can be opened on Linux only; let the camera's own program write raw frames to a pipe",
              device);
}

}  // namespace palpate
