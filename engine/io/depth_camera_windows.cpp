#include "engine/core/error.hpp"
#include "engine/io/depth_camera.hpp"

namespace palpate {

std::shared_ptr<DepthStream> openDepthCamera(const std::string& device, const CameraText&) {
  throw Error("{}: depth cameras are opened on Linux alone; let a program of the camera's write raw frames into a pipe",
              device);
}

}  // namespace palpate
