// Interface of a Linux video device, so that tests can simulate a camera.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "engine/io/depth_camera.hpp"

namespace palpate {

/// An open device. Functions that return an int return an errno value, 0 on success.
class VideoNode {
 public:
  virtual ~VideoNode() = default;
  /// A request of <linux/videodev2.h>.
  virtual int control(unsigned long request, void* argument) noexcept = 0;
  virtual int map(std::size_t bytes, std::int64_t offset, std::span<const std::byte>& memory) noexcept = 0;
  virtual void unmap(std::span<const std::byte> memory) noexcept = 0;
  /// Waits for a frame, an error of the device, or wake().
  virtual int wait() noexcept = 0;
  /// Interrupts the current wait and all later ones. From any thread.
  virtual void wake() noexcept = 0;
};

/// Streams the frames of a node; see openDepthCamera().
std::shared_ptr<DepthStream> streamVideoNode(std::unique_ptr<VideoNode> node, const std::string& name,
                                             const CameraText& camera);

}  // namespace palpate
